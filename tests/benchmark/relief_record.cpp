#include "tests/benchmark/relief_record.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace kokage {
namespace {

template <class T>
nlohmann::json number(const std::optional<T>& value) {
    return value && std::isfinite(double(*value)) ? nlohmann::json(*value) : nlohmann::json(nullptr);
}

} // namespace

nlohmann::json to_json(const ReliefRecord& record) {
    return {
        {"experiment", record.experiment},
        {"map", record.map},
        {"size", record.size},
        {"view", record.view},
        {"method", record.method},
        {"rays", record.rays},
        {"wrong", number(record.wrong)},
        {"ties", number(record.ties)},
        {"reads_mean", number(record.reads_mean)},
        {"reads_p99", number(record.reads_p99)},
        {"ns_per_ray", number(record.ns_per_ray)},
        {"preprocess_cpu_seconds", number(record.preprocess_cpu_seconds)},
        {"bytes", number(record.bytes)},
        {"rms_error", number(record.rms_error)},
        {"note", record.note},
    };
}

} // namespace kokage
