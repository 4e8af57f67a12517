// The voxel cube: its layout voxel by voxel against the formulas, lookups against an obvious twin, its ends.
#include "reflection/maps/voxel_cube.h"

#include "common/services/error.h"
#include "common/services/random.h"
#include "tests/unit/common/scene_builders.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

using test::random_direction;

VoxelCube cube_of_colours(int s, LobeKind kind = LobeKind::phong) {
    VoxelCube cube(kind, RoughnessScale::solved(s));
    std::vector<glm::vec3> texels(cube.layout().size());
    Random random(3);
    for (glm::vec3& texel : texels)
        for (int c = 0; c < 3; ++c)
            texel[c] = random.uniform();
    cube.set_texels(texels);
    return cube;
}

TEST(VoxelCube, EveryVoxelHoldsTheDirectionAndTheLobeOfItsPlace) {
    const RoughnessScale scale = RoughnessScale::solved(16);
    const VoxelCube cube(LobeKind::phong, scale);
    EXPECT_EQ(cube.size(), 18);
    const TexelLayout& layout = cube.layout();
    ASSERT_EQ(layout.size(), cube.voxel_of_texel().size());
    for (std::size_t i = 0; i < layout.size(); ++i) {
        const int v = int(cube.voxel_of_texel()[i]);
        const glm::dvec3 t = (glm::dvec3(v % 18, v / 18 % 18, v / 18 / 18) - 8.5) / 8.0;
        ASSERT_LT(glm::length(glm::dvec3(layout.directions[i]) - glm::normalize(t)), 1e-7);
        ASSERT_NEAR(double(layout.parameters[i]), scale.exponent(glm::length(t)), 1e-6 * layout.parameters[i]);
    }
    EXPECT_GT(*std::max_element(layout.parameters.begin(), layout.parameters.end()), 5000.f); // guards go on
}

TEST(VoxelCube, NoLookupReadsAVoxelThatIsNotInTheLayout) {
    VoxelCube cube(LobeKind::phong, RoughnessScale::solved(8));
    cube.set_texels(std::vector<glm::vec3>(cube.layout().size(), glm::vec3(1)));
    EXPECT_LT(cube.layout().size(), cube.voxels().size() * 3 / 4); // corners were left out
    Random random(1);
    for (int i = 0; i < 200000; ++i) {
        const glm::vec3 got = cube.lookup(random_direction(random), i % 3 == 0 ? 1.f : random.uniform());
        ASSERT_NEAR(got.g, 1, 1e-5f);
    }
    for (const glm::vec3& axis : {glm::vec3(1, 0, 0), glm::vec3(0, -1, 0), glm::vec3(0, 0, 1)})
        for (const float smoothness : {0.f, 0.5f, 1.f, 7.f, -1.f})
            EXPECT_NEAR(cube.lookup(axis, smoothness).r, 1, 1e-6f);
}

TEST(VoxelCube, LookupIsTrilinear) {
    const VoxelCube cube = cube_of_colours(8);
    Random random(2);
    const auto tent = [](double x) { return std::max(0.0, 1 - std::abs(x)); };
    for (int i = 0; i < 500; ++i) {
        const glm::vec3 direction = random_direction(random);
        const float smoothness = random.uniform();
        const double distance = std::min(std::hypot(4.0 * double(smoothness), 1.0), 4.0);
        const glm::dvec3 place = 4.5 + distance * glm::dvec3(direction);
        glm::dvec3 sum(0);
        for (int v = 0; v < 1000; ++v)
            sum += tent(place.x - v % 10) * tent(place.y - v / 10 % 10) * tent(place.z - v / 100) *
                   glm::dvec3(cube.voxels()[std::size_t(v)]);
        ASSERT_LT(glm::length(sum - glm::dvec3(cube.lookup(direction, smoothness))), 2e-6);
    }
}

TEST(VoxelCube, APartOfTheRangeIsCutOutOfTheWholeAndClampsToItsEnds) {
    const RoughnessScale scale = RoughnessScale::solved(16);
    const VoxelCube whole = cube_of_colours(16);
    const auto place = [](const VoxelCube& cube, std::size_t i) {
        const int n = cube.size(), v = int(cube.voxel_of_texel()[i]);
        return glm::ivec3(v % n, v / n % n, v / n / n) * 2 - (n - 1); // from the centre, in half voxels
    };
    const auto index = [](const VoxelCube& cube, const glm::ivec3& p) {
        const glm::ivec3 v = (p + (cube.size() - 1)) / 2;
        return std::size_t((v.z * cube.size() + v.y) * cube.size() + v.x);
    };
    for (const SmoothnessRange range : {SmoothnessRange{0.3, 0.6}, {0, 0.2}, {0, 0}, {0.5, 0.5}, {0.7, 1}, {0, 1}}) {
        VoxelCube part(LobeKind::phong, scale, range);
        const VoxelCube::Extent extent = VoxelCube::extent(16, range);
        EXPECT_EQ(extent.size, part.size());
        EXPECT_EQ(extent.texels, part.layout().size()) << range.roughest << " " << range.smoothest;
        EXPECT_LE(double(part.size()), std::max(16 * range.smoothest, 2.0) + 4);
        std::vector<glm::vec3> texels;
        for (std::size_t i = 0; i < part.layout().size(); ++i)
            texels.push_back(whole.voxels()[index(whole, place(part, i))]);
        part.set_texels(texels);
        for (std::size_t i = 0, j = 0; i < part.layout().size(); ++i, ++j) { // the same lobes at the same places
            while (place(whole, j) != place(part, i))
                ++j;
            ASSERT_EQ(part.layout().directions[i], whole.layout().directions[j]);
            ASSERT_EQ(part.layout().parameters[i], whole.layout().parameters[j]);
        }
        Random random(8);
        for (int i = 0; i < 3000; ++i) {
            const glm::vec3 direction = random_direction(random);
            const float smoothness = random.uniform();
            const float within = std::clamp(smoothness, float(range.roughest), float(range.smoothest));
            ASSERT_LT(glm::distance(part.lookup(direction, smoothness), whole.lookup(direction, within)), 1e-5f);
        }
    }
    EXPECT_THROW(VoxelCube(LobeKind::phong, scale, {0.6, 0.3}), InputError);
    EXPECT_THROW(VoxelCube(LobeKind::phong, scale, {0.6, 1.3}), InputError);
}

TEST(VoxelCube, ManyLookupsAreTheSameAsOneByOne) {
    const VoxelCube cube = cube_of_colours(12);
    Random random(5);
    std::vector<glm::vec3> directions(10001), filtered(directions.size());
    std::vector<float> smoothness(directions.size());
    for (std::size_t i = 0; i < directions.size(); ++i)
        directions[i] = random_direction(random), smoothness[i] = random.uniform(-0.1f, 1.1f);
    cube.lookup(directions, smoothness, filtered);
    for (std::size_t i = 0; i < directions.size(); ++i)
        ASSERT_EQ(filtered[i], cube.lookup(directions[i], smoothness[i]));
}

TEST(VoxelCube, GgxVoxelsHoldTheRoughnessOfTheSameSmoothness) {
    const RoughnessScale scale = RoughnessScale::solved(16);
    const VoxelCube cube(LobeKind::ggx, scale);
    for (std::size_t i = 0; i < cube.layout().size(); ++i) {
        const float roughness = cube.layout().parameters[i];
        ASSERT_GT(roughness, 0.f);
        ASSERT_LE(roughness, 1.f);
    }
    for (const double roughness : {0.15, 0.3, 0.6})
        EXPECT_NEAR(cube.smoothness(roughness), scale.smoothness(exponent_from_roughness(roughness)), 1e-6);
}

TEST(VoxelCube, WrongSizesAreRefused) {
    EXPECT_THROW(VoxelCube(LobeKind::phong, RoughnessScale::solved(9)), InputError);
    EXPECT_THROW(VoxelCube(LobeKind::phong, RoughnessScale::solved(2)), InputError);
    EXPECT_THROW(VoxelCube(LobeKind::phong, RoughnessScale::solved(4000)), InputError);
    VoxelCube cube(LobeKind::phong, RoughnessScale::solved(4));
    EXPECT_THROW(cube.set_texels(std::vector<glm::vec3>(3)), InputError);
}

} // namespace
} // namespace kokage
