#pragma once
// Heights for the renderer's relief: of bark as it was grown, or as a scene file tells.
#include "common/services/work_report.h"
#include "reflection/picture.h"
#include "trees/tree.h"
#include "viewer/scene/scene_description.h"

#include <map>

namespace kokage {

/// Each height map is made once, however many materials share it.
class MaterialReliefs {
  public:
    /// The heights that a material brought with it (TreeMaterial::height_texture); none where it brought none.
    LookRelief own(const TreeMaterial& material);
    /// What a scene file asks for: an image of heights, a normal map's, or, where it names neither, the material's own
    /// in another depth (none where it has none). What was repaired or is doubtful goes to the report's warnings.
    /// Throws InputError.
    LookRelief described(const ReliefDescription& description, const TreeMaterial& material, WorkReport& report);

  private:
    LookRelief from_heights(const ReliefDescription& description, WorkReport& report);
    LookRelief from_normals(const ReliefDescription& description, WorkReport& report);

    std::map<std::shared_ptr<const Image>, LookRelief> of_images_; ///< 1 m deep
    std::map<std::filesystem::path, LookRelief> of_files_;         ///< 1 m deep; normals in metres of a tile of 1 m
};

} // namespace kokage
