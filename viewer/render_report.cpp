#include "viewer/render_report.h"
#include "common/services/memory.h"
#include "viewer/report_json.h"

#include <nlohmann/json.hpp>

namespace kokage {
namespace {
using Json = nlohmann::ordered_json;

Json camera_json(const Camera& camera) {
    return {{"position", vector_json(camera.position)},
            {"target", vector_json(camera.target)},
            {"up", vector_json(camera.up)},
            {"field_of_view", number_json(double(camera.vertical_field_of_view) * 180 / kPiDouble)}};
}

Json trees_json(const SceneDescription& description) {
    Json trees = Json::array();
    for (const PlacedTree& tree : description.trees)
        trees.push_back({{"source", tree.source.name},
                         {"at", {tree.placement.at.x, tree.placement.at.y, tree.placement.at.z}},
                         {"turn", tree.placement.turn_degrees},
                         {"size", tree.placement.size}});
    return trees;
}

Json objects_json(const SceneDescription& description) {
    Json objects = Json::array();
    for (const PlacedObject& object : description.objects)
        objects.push_back({{"file", object.file.string()},
                           {"at", {object.placement.at.x, object.placement.at.y, object.placement.at.z}},
                           {"turn", object.placement.turn_degrees},
                           {"material", object.material}});
    return objects;
}

} // namespace

const char* render_method_name(RenderMethod method) {
    return method == RenderMethod::fast ? "fast" : "path-traced";
}

Json render_report(const RenderRecord& record) {
    const AssembledScene& scene = *record.scene;
    const PictureOptions& picture = record.options.picture;
    Json counts = {{"trees", record.description->trees.size()},
                   {"objects", record.description->objects.size()},
                   {"leaves", scene.tree.leaves.size()},
                   {"patches", scene.patches.patches.size()},
                   {"triangles", scene.patches.triangles.size()}};
    for (const WorkReport::Count& count : record.work.counts)
        counts[count.name] = count.value;
    Json report;
    report["program"] = "kokage " KOKAGE_VERSION;
    report["inputs"] = {{"arguments", pairs_json(record.arguments)},
                        {"scene", record.description->name},
                        {"trees", trees_json(*record.description)},
                        {"objects", objects_json(*record.description)},
                        {"environment", environment_json(scene.environment, scene.environment_report)},
                        {"camera", camera_json(scene.camera)}};
    if (scene.patches.ground)
        report["inputs"]["ground"] = {{"height_m", number_json(double(scene.patches.ground->height_m))},
                                      {"albedo", vector_json(scene.patches.ground->albedo)}};
    report["method"] = {{"name", render_method_name(record.options.method)}};
    report["method"]["asked_error"] =
        record.options.method == RenderMethod::fast ? number_json(record.options.error) : Json(nullptr);
    report["picture"] = {{"width", picture.width},
                         {"height", picture.height},
                         {"samples", picture.samples},
                         {"seed", picture.seed},
                         {"exposure_stops", number_json(record.exposure_stops)},
                         {"exposure_chosen_by", picture.exposure_stops ? "the user" : "the program"},
                         {"subject_share", number_json(record.subject_share)},
                         {"subject_mean_luminance", number_json(record.subject_radiance)}};
    report["counts"] = std::move(counts);
    report["stages"] = stages_json(record.work);
    report["render_stages"] = stages_json(record.picture);
    report["cpu_seconds"] = number_json(record.cpu_seconds);
    report["wall_seconds"] = number_json(record.wall_seconds);
    report["peak_memory_bytes"] = peak_memory_bytes();
    report["skipped"] = skips_json(record.work);
    report["warnings"] = record.work.warnings;
    report["outputs"] = pairs_json(record.outputs);
    return report;
}

} // namespace kokage
