#include "tests/benchmark/tree_record.h"

#include <nlohmann/json.hpp>

namespace kokage {

nlohmann::json to_json(const TreeRecord& record) {
    auto number = [](std::optional<double> value) { return value ? nlohmann::json(*value) : nlohmann::json(nullptr); };
    return {{"generator", record.generator},
            {"species", record.species},
            {"leaves", record.leaves},
            {"triangles", record.triangles},
            {"cpu_seconds", record.cpu_seconds},
            {"bytes", record.bytes},
            {"skeleton_and_leaves_cpu_seconds", number(record.skeleton_and_leaves_cpu_seconds)},
            {"bark_cpu_seconds", number(record.bark_cpu_seconds)}};
}

TreeRecord tree_record_of_peer(const std::string& generator, const std::string& line) {
    const nlohmann::json json = nlohmann::json::parse(line);
    TreeRecord record;
    record.generator = generator;
    json.at("species").get_to(record.species);
    json.at("leaves").get_to(record.leaves);
    json.at("triangles").get_to(record.triangles);
    json.at("cpu_seconds").get_to(record.cpu_seconds);
    json.at("bytes").get_to(record.bytes);
    return record;
}

} // namespace kokage
