#pragma once
// What a stored truth of a picture belongs to.
#include "viewer/scene/assemble_scene.h"

#include <cstdint>

namespace kokage {

/// Hash of all that a path-traced picture depends on: triangles, normals, texture coordinates, masks, optics, looks
/// with their textures and heights, ground, environment, camera, the picture's size and which of its pixels are traced.
/// Numbers come out of exponentials and sines, whose last bit differs between machines: as in environment_hash(),
/// randomly weighted sums of them are rounded to 5 digits. Weights have both signs, so that a sum is about as large as
/// the root of its count: a single number among a million that changes by a hundredth of itself shows.
std::uint64_t picture_hash(const AssembledScene& scene, const PictureOptions& picture);

} // namespace kokage
