#include "viewer/shading_report.h"
#include "common/services/memory.h"
#include "viewer/report_json.h"

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

namespace kokage {
namespace {
using Json = nlohmann::ordered_json;

Json tree_json(const Tree& tree) {
    return {
        {"name", tree.name}, {"source", tree.source}, {"branching_known", tree.branching_known}, {"notes", tree.notes}};
}

Json optics_json(const PatchScene& scene) {
    std::map<std::uint32_t, std::pair<std::string, std::size_t>> used;
    for (const Patch& patch : scene.patches) {
        auto& [kind, count] = used[patch.optics];
        kind = patch.kind == PatchKind::leaf ? "leaf" : "bark";
        ++count;
    }
    Json json = Json::array();
    for (const auto& [index, use] : used)
        json.push_back({{"kind", use.first},
                        {"patches", use.second},
                        {"reflectance", vector_json(scene.optics[index].reflectance)},
                        {"transmittance", vector_json(scene.optics[index].transmittance)}});
    return json;
}

Json method_json(const ShadingRecord& record) {
    const ShadingOptions& o = record.options;
    const std::string& instead = record.solution->method_instead;
    Json json = {{"name", instead.empty() ? std::string(method_name(o.method)) : instead},
                 {"asked_name", method_name(o.method)}};
    json["asked_error"] = o.method == Method::paper ? Json(nullptr) : Json(o.error);
    json["effort"] = o.effort;
    json["maps"] = o.maps;
    json["bands"] = o.bands;
    json["max_bounces"] = o.max_bounces;
    json["gather"] = o.gather == GatherRule::rule ? "rule" : "cosine";
    json["seed"] = o.seed;
    return json;
}

} // namespace

Json shading_report(const ShadingRecord& record) {
    const Solution& solution = *record.solution;
    WorkReport all = record.work;
    all.append(solution.report);

    Json counts = {{"leaves", record.tree->leaves.size()},      {"branches", record.tree->skeleton.branches.size()},
                   {"patches", record.patches->patches.size()}, {"triangles", record.patches->triangles.size()},
                   {"maps", solution.light_maps.size()},        {"transport_bytes", solution.transport_bytes}};
    for (const WorkReport::Count& count : all.counts)
        counts[count.name] = count.value;
    Json residuals = Json::array();
    for (double residual : solution.residuals)
        residuals.push_back(number_json(residual));

    Json report;
    report["program"] = "kokage " KOKAGE_VERSION;
    report["inputs"] = {{"arguments", pairs_json(record.arguments)},
                        {"tree", tree_json(*record.tree)},
                        {"environment", environment_json(*record.environment, record.environment_report)},
                        {"optics", optics_json(*record.patches)}};
    if (record.patches->ground)
        report["inputs"]["ground"] = {{"height_m", number_json(double(record.patches->ground->height_m))},
                                      {"albedo", vector_json(record.patches->ground->albedo)}};
    report["method"] = method_json(record);
    report["counts"] = std::move(counts);
    report["stages"] = stages_json(record.work);
    report["method_stages"] = stages_json(solution.report);
    report["cpu_seconds"] = number_json(record.cpu_seconds);
    report["wall_seconds"] = number_json(record.wall_seconds);
    report["peak_memory_bytes"] = peak_memory_bytes();
    report["residuals"] = std::move(residuals);
    const double in = solution.energy_in, out = solution.energy_absorbed + solution.energy_escaped;
    report["energy"] = {{"in", number_json(in)},
                        {"absorbed", number_json(solution.energy_absorbed)},
                        {"escaped", number_json(solution.energy_escaped)},
                        {"balance", number_json(in > 0 ? out / in : NAN)}};
    report["estimated_error"] = solution.estimated_error ? number_json(*solution.estimated_error) : Json(nullptr);
    report["skipped"] = skips_json(all);
    report["warnings"] = all.warnings;
    report["outputs"] = pairs_json(record.outputs);
    return report;
}

} // namespace kokage
