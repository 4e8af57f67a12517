#include "common/scene/alpha_mask.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

int texel(float coordinate, int size, TextureWrap wrap) {
    if (wrap == TextureWrap::clamp)
        return std::clamp(int(std::floor(std::clamp(coordinate, 0.f, 1.f) * float(size))), 0, size - 1);
    if (wrap == TextureWrap::mirror) {
        const float t = coordinate - 2.f * std::floor(coordinate * 0.5f);
        coordinate = t > 1.f ? 2.f - t : t;
    } else {
        coordinate -= std::floor(coordinate);
    }
    return std::clamp(int(coordinate * float(size)), 0, size - 1);
}

} // namespace

bool AlphaMask::solid(glm::vec2 uv) const {
    const int x = texel(uv.x, alpha->width, wrap_u), y = texel(uv.y, alpha->height, wrap_v);
    return alpha->at(x, y)[0] >= cutoff;
}

} // namespace kokage
