#pragma once
// What every solution must be, whatever was shaded; and trees of other sizes and places to shade.
#include "foliage/solution.h"
#include "tests/unit/foliage/small_trees.h"

#include <cmath>
#include <gtest/gtest.h>

namespace kokage::test {

/// No number is NaN or infinite, no light is negative, shares are shares, directions are unit or 0.
inline void expect_finite(const Solution& solution) {
    const auto finite = [](const glm::vec3& v) {
        return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
    };
    for (const SideRadiance* sides : {&solution.radiance, &solution.indirect})
        for (const std::vector<glm::vec3>* side : {&sides->front, &sides->back})
            for (const glm::vec3& value : *side)
                ASSERT_TRUE(finite(value) && value.r >= 0 && value.g >= 0 && value.b >= 0)
                    << value.r << ", " << value.g << ", " << value.b;
    for (const std::vector<float>* visibility : {&solution.sky_visibility_front, &solution.sky_visibility_back})
        for (float share : *visibility)
            ASSERT_TRUE(share >= 0 && share <= 1) << share;
    for (const glm::vec3& normal : solution.bent_normal)
        ASSERT_TRUE(std::abs(glm::length(normal) - 1) < 1e-4f || normal == glm::vec3(0));
    for (const LightMap& map : solution.light_maps)
        for (const glm::vec3& coefficient : map.coefficients)
            ASSERT_TRUE(finite(coefficient));
    EXPECT_TRUE(std::isfinite(solution.energy_in + solution.energy_absorbed + solution.energy_escaped));
    EXPECT_TRUE(std::isfinite(solution.estimated_error.value_or(0)));
    for (double residual : solution.residuals)
        EXPECT_TRUE(std::isfinite(residual));
}

/// Mean green radiance of all sides.
inline double mean(const Solution& solution) {
    double sum = 0;
    for (std::size_t p = 0; p < solution.radiance.front.size(); ++p)
        sum += double(solution.radiance.front[p].g) + double(solution.radiance.back[p].g);
    return sum / std::max<double>(1, double(2 * solution.radiance.front.size()));
}

/// The same tree on the same ground, scaled and moved.
inline SmallTree transformed(SmallTree small, float scale, const glm::vec3& shift) {
    for (glm::vec3& position : small.scene.positions)
        position = scale * position + shift;
    if (small.scene.ground)
        small.scene.ground->height_m = scale * small.scene.ground->height_m + shift.y;
    for (Leaf& leaf : small.tree.leaves)
        leaf.centre = scale * leaf.centre + shift;
    for (Branch& branch : small.tree.skeleton.branches)
        for (Branch::Node& node : branch.nodes) {
            node.position = scale * node.position + shift;
            node.radius_m *= scale;
        }
    return small;
}

} // namespace kokage::test
