#pragma once
#include "common/scene/patch_scene.h"

#include <vector>

namespace kokage {

/// One point and one direction for each patch, for methods that read light at a patch's middle.
struct PatchGeometry {
    std::vector<glm::vec3> centres; ///< area centroid; the corners' mean where the area is zero
    std::vector<glm::vec3> normals; ///< unit mean normal of the front; +Y where the area is zero
    std::vector<float> flatness; ///< length of the area's mean normal: 1 = flat, 0 = closed; 1 where the area is zero
};

/// Cross product of a triangle's edges: twice its area, along the front's normal.
glm::dvec3 twice_area_vector(const PatchScene& scene, std::uint32_t triangle);

PatchGeometry patch_geometry(const PatchScene& scene);

} // namespace kokage
