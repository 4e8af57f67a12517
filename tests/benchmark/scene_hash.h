#pragma once
// What a stored reference belongs to: everything that its light depends on.
#include "common/environment/environment.h"
#include "common/scene/patch_scene.h"

#include <cstdint>

namespace kokage {

/// Hash of the geometry (every corner's bits, which triangles make which leaf, masks), the optics and the ground.
/// How vertices are shared and where bark is cut into patches does not enter: path tracing does not see it.
std::uint64_t geometry_hash(const PatchScene& scene);

/// Hash of an environment. Its numbers come out of exponentials and sines, whose last bit differs between machines,
/// so 24 randomly weighted sums over the image and the lights are rounded to 5 digits: any change of 1e-4 of the energy
/// gives another hash, the last bit of a float does not.
std::uint64_t environment_hash(const Environment& environment);

} // namespace kokage
