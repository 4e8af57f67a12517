#pragma once
// Many lobes towards many points of light, by vectors.
#include "reflection/maps/lobe_lights.h"

namespace kokage {

/// Texels as arrays; readable up to a whole vector of 16 beyond `count`.
struct LobeArrays {
    const float *x, *y, *z, *shape, *peak;
    std::size_t count;
};

/// sums[c * stride + i] = sum over points of irradiance c x lobe i towards the point. `stride` >= count, and there is
/// room for a vector of 16 beyond.
void sum_lobes(LobeKind kind, const LobeArrays& texels, std::span<const PointOfLight> points, float* sums,
               std::size_t stride);

} // namespace kokage
