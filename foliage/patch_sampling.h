#pragma once
#include "common/scene/patch_scene.h"
#include "common/services/random.h"

namespace kokage {

struct PatchPoint {
    glm::vec3 position{0.f};
    glm::vec3 normal{0, 1, 0}; ///< unit, of the triangle's front
};

/// A random point of a patch, uniform over its solid area (holes of alpha masks are avoided as far as 32 tries go). A
/// patch of zero area gives a point of its first triangle with the normal +Y.
PatchPoint sample_patch(const PatchScene& scene, std::uint32_t patch, Random& random);

/// A direction of the hemisphere around `normal`, distributed as its cosine; u0 and u1 in [0,1).
glm::vec3 cosine_direction(const glm::vec3& normal, float u0, float u1);

} // namespace kokage
