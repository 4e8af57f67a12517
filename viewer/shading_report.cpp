#include "viewer/shading_report.h"

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

namespace kokage {
namespace {
using Json = nlohmann::ordered_json;

Json number(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json color(const glm::vec3& rgb) {
    return Json::array({number(double(rgb.r)), number(double(rgb.g)), number(double(rgb.b))});
}

Json pairs(const std::vector<std::pair<std::string, std::string>>& list) {
    Json json = Json::object();
    for (const auto& [name, value] : list) {
        if (!json.contains(name))
            json[name] = value;
        else if (json[name].is_array())
            json[name].push_back(value);
        else
            json[name] = Json::array({json[name], value});
    }
    return json;
}

Json tree_json(const Tree& tree) {
    return {
        {"name", tree.name}, {"source", tree.source}, {"branching_known", tree.branching_known}, {"notes", tree.notes}};
}

Json environment_json(const Environment& environment, const EnvironmentReport& report) {
    Json lights = Json::array();
    for (const DistantLight& light : environment.distant_lights)
        lights.push_back({{"name", light.name},
                          {"direction", color(light.direction)},
                          {"half_angle", number(double(light.half_angle))},
                          {"irradiance", color(light.irradiance)}});
    for (const PointLight& light : environment.point_lights)
        lights.push_back(
            {{"name", light.name}, {"position", color(light.position)}, {"intensity", color(light.intensity)}});
    Json json = {
        {"description", environment.description},
        {"bad_pixels",
         {{"nan", report.nan_pixels}, {"infinite", report.infinite_pixels}, {"negative", report.negative_pixels}}},
        {"bright_regions_found", report.regions_found},
        {"energy_before", number(report.energy_before)},
        {"energy_after", number(report.energy_after)},
        {"lights", std::move(lights)}};
    if (report.first_bad_x >= 0)
        json["bad_pixels"]["first"] = {report.first_bad_x, report.first_bad_y};
    if (!report.note.empty())
        json["note"] = report.note;
    return json;
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
                        {"reflectance", color(scene.optics[index].reflectance)},
                        {"transmittance", color(scene.optics[index].transmittance)}});
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

Json stages_json(const WorkReport& report) {
    Json json = Json::array();
    for (const WorkReport::Stage& stage : report.stages)
        json.push_back({{"name", stage.name},
                        {"cpu_seconds", number(stage.cpu_seconds)},
                        {"wall_seconds", number(stage.wall_seconds)}});
    return json;
}

} // namespace

std::uint64_t peak_memory_bytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return std::uint64_t(usage.ru_maxrss) * 1024;
}

Json shading_report(const ShadingRecord& record) {
    const Solution& solution = *record.solution;
    WorkReport all = record.work;
    all.append(solution.report);

    Json counts = {{"leaves", record.tree->leaves.size()},      {"branches", record.tree->skeleton.branches.size()},
                   {"patches", record.patches->patches.size()}, {"triangles", record.patches->triangles.size()},
                   {"maps", solution.light_maps.size()},        {"transport_bytes", solution.transport_bytes}};
    for (const WorkReport::Count& count : all.counts)
        counts[count.name] = count.value;
    Json skipped = Json::array();
    for (const WorkReport::Skip& skip : all.skips)
        skipped.push_back({{"what", skip.what}, {"why", skip.why}, {"would_have_cost", skip.saved}});
    Json residuals = Json::array();
    for (double residual : solution.residuals)
        residuals.push_back(number(residual));

    Json report;
    report["program"] = "kokage " KOKAGE_VERSION;
    report["inputs"] = {{"arguments", pairs(record.arguments)},
                        {"tree", tree_json(*record.tree)},
                        {"environment", environment_json(*record.environment, record.environment_report)},
                        {"optics", optics_json(*record.patches)}};
    if (record.patches->ground)
        report["inputs"]["ground"] = {{"height_m", number(double(record.patches->ground->height_m))},
                                      {"albedo", color(record.patches->ground->albedo)}};
    report["method"] = method_json(record);
    report["counts"] = std::move(counts);
    report["stages"] = stages_json(record.work);
    report["method_stages"] = stages_json(solution.report);
    report["cpu_seconds"] = number(record.cpu_seconds);
    report["wall_seconds"] = number(record.wall_seconds);
    report["peak_memory_bytes"] = peak_memory_bytes();
    report["residuals"] = std::move(residuals);
    const double in = solution.energy_in, out = solution.energy_absorbed + solution.energy_escaped;
    report["energy"] = {{"in", number(in)},
                        {"absorbed", number(solution.energy_absorbed)},
                        {"escaped", number(solution.energy_escaped)},
                        {"balance", number(in > 0 ? out / in : NAN)}};
    report["estimated_error"] = solution.estimated_error ? number(*solution.estimated_error) : Json(nullptr);
    report["skipped"] = std::move(skipped);
    report["warnings"] = all.warnings;
    report["outputs"] = pairs(record.outputs);
    return report;
}

} // namespace kokage
