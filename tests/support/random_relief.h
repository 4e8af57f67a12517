#pragma once
// Random height fields and rays for tests: small, of odd sizes, and with many odd cases among them.
#include "common/services/random.h"
#include "reflection/relief/relief_ray.h"

#include <algorithm>
#include <cmath>

namespace kokage {

/// Any size up to `most_size`, both wraps: white noise, smooth waves, plateaus of few heights (ties), lone spikes,
/// constant maps.
inline HeightField random_height_field(Random& random, int most_size = 24) {
    HeightField field;
    field.width = 1 + int(random.below(std::uint32_t(most_size)));
    field.height = random.below(4) == 0 ? field.width : 1 + int(random.below(std::uint32_t(most_size)));
    field.wrap = random.below(4) == 0 ? HeightWrap::clamp : HeightWrap::repeat;
    const std::uint32_t kind = random.below(8);
    const float level = float(random.below(5)) / 4, turns_x = float(random.below(4)), turns_y = float(random.below(4));
    for (int y = 0; y < field.height; ++y)
        for (int x = 0; x < field.width; ++x) {
            const float turn = 6.2831853f * (turns_x * (float(x) + 0.5f) / float(field.width) +
                                             turns_y * (float(y) + 0.5f) / float(field.height));
            float depth = random.uniform();
            if (kind == 0)
                depth = level;
            else if (kind == 1)
                depth = float(random.below(3)) / 2;
            else if (kind == 2)
                depth = depth < 0.05f ? 0.f : 1.f;
            else if (kind <= 5)
                depth = 0.5f + 0.45f * std::sin(turn) + (kind == 5 ? 0.05f * (2 * depth - 1) : 0.f);
            field.depths.push_back(std::clamp(depth, 0.f, 1.f));
        }
    return field;
}

/// From anywhere (above, on, within, below; far away; on borders of texels) to anywhere (steep, grazing, upwards, along
/// an axis or a diagonal, parallel to the surface, with denormal components).
inline ReliefRay random_relief_ray(Random& random, const HeightField& field) {
    ReliefRay ray;
    const glm::vec2 size(field.width, field.height);
    for (int axis = 0; axis < 2; ++axis) {
        float& at = ray.origin[axis];
        at = random.uniform(-2.f, 3.f);
        const std::uint32_t kind = random.below(8);
        if (kind == 0) // on a border or a centre of a texel
            at = (float(random.below(2 * std::uint32_t(size[axis]) + 1)) / 2) / size[axis];
        else if (kind == 1)
            at = random.uniform(-1000.f, 1000.f);
    }
    const std::uint32_t start = random.below(8);
    ray.origin.z = start == 0   ? random.uniform()
                   : start == 1 ? -random.uniform(0.f, 10.f)
                   : start == 2 ? random.uniform(0.f, 3.f)
                                : 0.f;
    const float turn = random.below(4) == 0 ? 0.78539816f * float(random.below(8)) : random.uniform(0.f, 6.2831853f);
    const float across = std::exp2(random.uniform(-8.f, 6.f)); // tiles that it passes within the relief
    ray.direction = {across * std::cos(turn), across * std::sin(turn), random.below(8) == 0 ? -1.f : 1.f};
    const std::uint32_t kind = random.below(16);
    if (kind < 3)
        ray.direction[int(kind)] = 0;
    else if (kind == 3)
        ray.direction[int(random.below(3))] = 1e-41f;
    else if (kind == 4)
        ray.direction = {0, 0, 1};
    if (random.below(4) == 0)
        ray.direction *= std::exp2(random.uniform(-10.f, 10.f));
    if (random.below(8) == 0)
        ray.t_most = random.uniform(0.f, 2.f);
    return ray;
}

} // namespace kokage
