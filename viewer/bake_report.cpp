#include "viewer/bake_report.h"
#include "common/services/memory.h"
#include "viewer/scene/output_check.h"

#include <nlohmann/json.hpp>

namespace kokage {
namespace {
using Json = nlohmann::ordered_json;

Json surroundings_json(const Environment& environment, const EnvironmentReport& report) {
    Json lights = Json::array();
    for (const DistantLight& light : environment.distant_lights)
        lights.push_back(light.name);
    Json json = {
        {"description", environment.description},
        {"width", environment.remainder.width},
        {"height", environment.remainder.height},
        {"bad_pixels",
         {{"nan", report.nan_pixels}, {"infinite", report.infinite_pixels}, {"negative", report.negative_pixels}}},
        {"added_lights", std::move(lights)}};
    if (!report.note.empty())
        json["note"] = report.note;
    return json;
}

Json sequence_json(const SequenceResult& result) {
    Json broken = Json::array();
    for (const BrokenFrame& frame : result.first_broken)
        broken.push_back({{"frame", frame.number}, {"why", frame.why}});
    const auto a_frame = [&](double seconds) { return result.baked > 0 ? seconds / double(result.baked) : 0; };
    return {{"frames", result.frames},
            {"baked", result.baked},
            {"kept", result.kept},
            {"broken", result.broken},
            {"wall_seconds", result.wall_seconds},
            {"setup_cpu_seconds", result.setup_cpu_seconds},
            {"setup_wall_seconds", result.setup_wall_seconds},
            {"frames_per_second", result.frames_per_second()},
            {"cpu_seconds_a_frame",
             {{"reading", a_frame(result.reading_cpu_seconds)},
              {"baking", a_frame(result.baking_cpu_seconds)},
              {"writing", a_frame(result.writing_cpu_seconds)}}},
            {"first_broken", std::move(broken)}};
}

/// A lobe in both words that users have for it; the image itself has roughness 0 and no exponent.
void add_lobe(Json& json, const Lobe& lobe, bool unfiltered) {
    const bool phong = lobe.kind == LobeKind::phong;
    json["roughness"] = unfiltered ? 0 : phong ? roughness_from_exponent(lobe.parameter) : lobe.parameter;
    json["exponent"] = nullptr;
    if (!unfiltered)
        json["exponent"] = phong ? lobe.parameter : exponent_from_roughness(lobe.parameter);
}

Json map_json(const BakeOptions& o) {
    Json json = {{"file", o.output},
                 {"container", map_container_name(o.map.container)},
                 {"size", o.plan.size},
                 {"filtered_texels", o.plan.texels},
                 {"bytes", o.plan.bytes}};
    if (o.map.container != MapContainer::harmonics)
        json["rounding"] = format_rounding(o.map.format);
    if (o.map.container == MapContainer::voxel_cube) {
        const SmoothnessRange range = smoothness_of(o.map);
        json["smoothness"] = {range.roughest, range.smoothest};
    }
    if (!o.plan.levels.empty())
        json["levels"] = Json::array();
    if (o.map.lobe == LobeKind::phong && o.map.container != MapContainer::harmonics) {
        const RoughnessScale scale = scale_of(o.map);
        json["roughness_scale"] = {{"u", scale.u()}, {"levels", scale.levels()}, {"cube_size", scale.cube_size()}};
    }
    for (const MapLevel& level : o.plan.levels) {
        json["levels"].push_back({{"size", level.size}, {"is_the_image", level.unfiltered}});
        add_lobe(json["levels"].back(), level.lobe, level.unfiltered);
    }
    return json;
}

} // namespace

Json bake_identity(const BakeOptions& o) {
    if (o.map.container == MapContainer::harmonics)
        return {{"program", "kokage " KOKAGE_VERSION}, {"container", map_container_name(o.map.container)},
                {"bands", o.map.harmonics.bands},      {"quantity", o.quantity},
                {"list_lights", o.list_lights},        {"output", std::filesystem::path(o.output).filename().string()},
                {"lights", o.surroundings.lights},     {"strict", o.surroundings.strict}};
    Json json = {{"program", "kokage " KOKAGE_VERSION},
                 {"container", map_container_name(o.map.container)},
                 {"lobe", lobe_kind_name(o.map.lobe)},
                 {"size", o.map.size},
                 {"levels", o.map.levels},
                 {"detail", o.map.texels_a_width},
                 {"filter", o.filter},
                 {"format", o.format},
                 {"compression", o.compression},
                 {"smoothness", o.smoothness},
                 {"roughness", o.roughness},
                 {"output", std::filesystem::path(o.output).filename().string()},
                 {"method", o.method},
                 {"lights", o.surroundings.lights},
                 {"strict", o.surroundings.strict}};
    if (o.map.lobe == LobeKind::phong)
        json["roughness_scale"] = o.roughness_scale;
    if (o.baker.method == BakeMethod::spectral)
        json["tolerance"] = o.baker.tolerance;
    if (o.baker.method == BakeMethod::table) {
        json["threshold"] = o.baker.table.threshold;
        json["weights"] = o.weights;
    }
    return json;
}

Json bake_report(const BakeRecord& record) {
    const BakeOptions& o = *record.options;
    Json json = {{"inputs", {{"environment", o.surroundings.environment}}}, {"settings", bake_identity(o)}};
    if (record.environment)
        json["inputs"]["surroundings"] = surroundings_json(*record.environment, record.environment_report);
    json["map"] = map_json(o);
    if (record.sequence)
        json["sequence"] = sequence_json(*record.sequence);
    json["counts"] = Json::object();
    for (const WorkReport::Count& count : record.work.counts)
        json["counts"][count.name] = count.value;
    json["stages"] = Json::array();
    for (const WorkReport::Stage& stage : record.work.stages)
        json["stages"].push_back(
            {{"name", stage.name}, {"cpu_seconds", stage.cpu_seconds}, {"wall_seconds", stage.wall_seconds}});
    json["skipped"] = Json::array();
    for (const WorkReport::Skip& skip : record.work.skips)
        json["skipped"].push_back({{"what", skip.what}, {"why", skip.why}, {"saved", skip.saved}});
    json["warnings"] = record.work.warnings;
    json["cpu_seconds"] = record.cpu_seconds;
    json["wall_seconds"] = record.wall_seconds;
    json["peak_memory_bytes"] = peak_memory_bytes();
    return json;
}

} // namespace kokage
