#include "reflection/texture_lookup.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

/// `texel` from -1 to 2 size, without a division.
int wrap(int texel, int size, TextureWrap mode) {
    if (mode == TextureWrap::clamp)
        return std::clamp(texel, 0, size - 1);
    if (texel < 0)
        texel += 2 * size;
    if (texel >= 2 * size)
        texel -= 2 * size;
    if (texel < size)
        return texel;
    return mode == TextureWrap::repeat ? texel - size : 2 * size - 1 - texel;
}

} // namespace

TexelBlend texels_at(const Image& image, glm::vec2 uv, TextureWrap wrap_u, TextureWrap wrap_v) {
    uv.x = wrap_u == TextureWrap::clamp ? std::clamp(uv.x, 0.f, 1.f) : uv.x - 2.f * std::floor(uv.x * 0.5f);
    uv.y = wrap_v == TextureWrap::clamp ? std::clamp(uv.y, 0.f, 1.f) : uv.y - 2.f * std::floor(uv.y * 0.5f);
    const float x = uv.x * float(image.width) - 0.5f, y = uv.y * float(image.height) - 0.5f;
    const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
    const float fx = x - float(x0), fy = y - float(y0);
    TexelBlend blend{};
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            blend.texels[2 * j + i] = image.at(wrap(x0 + i, image.width, wrap_u), wrap(y0 + j, image.height, wrap_v));
            blend.weights[2 * j + i] = (i ? fx : 1 - fx) * (j ? fy : 1 - fy);
        }
    return blend;
}

glm::vec3 texture_color(const Image& image, glm::vec2 uv, TextureWrap wrap_u, TextureWrap wrap_v) {
    const TexelBlend blend = texels_at(image, uv, wrap_u, wrap_v);
    glm::vec3 sum(0.f);
    for (int k = 0; k < 4; ++k)
        sum += blend.weights[k] * glm::vec3(blend.texels[k][0], blend.texels[k][1], blend.texels[k][2]);
    return sum;
}

float texture_value(const Image& image, glm::vec2 uv, TextureWrap wrap_u, TextureWrap wrap_v) {
    const TexelBlend blend = texels_at(image, uv, wrap_u, wrap_v);
    float sum = 0;
    for (int k = 0; k < 4; ++k)
        sum += blend.weights[k] * blend.texels[k][0];
    return sum;
}

} // namespace kokage
