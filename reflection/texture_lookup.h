#pragma once
// Textures between their texels.
#include "common/scene/alpha_mask.h"
#include "common/scene/image.h"
#include "common/types.h"

namespace kokage {

/// The four texels around a place and their weights, as bilinear interpolation has them. Coordinates are first reduced
/// to two tiles, so that any finite value is exact enough.
struct TexelBlend {
    const float* texels[4];
    float weights[4];
};
TexelBlend texels_at(const Image& image, glm::vec2 uv, TextureWrap wrap_u, TextureWrap wrap_v);

/// The first three channels, which the image must have.
glm::vec3 texture_color(const Image& image, glm::vec2 uv, TextureWrap wrap_u, TextureWrap wrap_v);
/// The first channel.
float texture_value(const Image& image, glm::vec2 uv, TextureWrap wrap_u, TextureWrap wrap_v);

} // namespace kokage
