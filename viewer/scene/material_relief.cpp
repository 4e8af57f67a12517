#include "viewer/scene/material_relief.h"
#include "reflection/relief/integrate_normals.h"

namespace kokage {
namespace {

LookRelief as_look(Relief relief) {
    return {std::make_shared<const HeightField>(std::move(relief.field)), relief.scale.depth_m, 0};
}

void warn(const std::vector<std::string>& notes, const std::filesystem::path& file, WorkReport& report) {
    for (const std::string& note : notes)
        report.warnings.push_back(file.string() + ": " + note);
}

} // namespace

LookRelief MaterialReliefs::own(const TreeMaterial& material) {
    if (!material.height_texture || !(material.height_depth_m > 0))
        return {};
    LookRelief& known = of_images_[material.height_texture];
    if (!known.heights) {
        HeightImageReport report;
        known = as_look(relief_from_image(*material.height_texture, {glm::vec2(1.f), 1.f}, material.name, {}, report));
    }
    return {known.heights, known.depth_m * material.height_depth_m, material.height_tile_m};
}

LookRelief MaterialReliefs::from_heights(const ReliefDescription& description, WorkReport& report) {
    LookRelief& known = of_files_[description.heights];
    if (!known.heights) {
        HeightImageReport notes;
        known = as_look(load_relief(description.heights, {glm::vec2(1.f), 1.f}, {}, notes));
        warn(notes.notes, description.heights, report);
    }
    return {known.heights, known.depth_m * float(description.depth_m), 0};
}

LookRelief MaterialReliefs::from_normals(const ReliefDescription& description, WorkReport& report) {
    LookRelief& known = of_files_[description.normals];
    if (!known.heights) {
        NormalMapReport notes;
        known = as_look(load_relief_from_normals(description.normals, {}, notes));
        warn(notes.notes, description.normals, report);
    }
    if (description.depth_m > 0)
        return {known.heights, float(description.depth_m), 0};
    const auto repeat = float(description.repeat_m); // heights grow with the tile
    return {known.heights, known.depth_m * repeat, repeat};
}

LookRelief MaterialReliefs::described(const ReliefDescription& description, const TreeMaterial& material,
                                      WorkReport& report) {
    if (description.none)
        return {};
    if (!description.heights.empty())
        return from_heights(description, report);
    if (!description.normals.empty())
        return from_normals(description, report);
    LookRelief relief = own(material);
    if (relief.heights)
        relief.depth_m =
            description.depth_m > 0 ? float(description.depth_m) : relief.depth_m * float(description.scale);
    return relief;
}

} // namespace kokage
