#include "common/directions/spherical_harmonics.h"
#include "foliage/light_map_field.h"
#include "foliage/patch_light_maps.h"
#include "tests/unit/foliage/small_trees.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace kokage {
namespace {

/// A ball of leaves over ground, everything of radiance 1 but the ground, which sends its albedo.
struct EvenWorld {
    test::SmallTree small = test::ball_on_a_skeleton(400, 2, test::bright_leaf());
    SideRadiance radiance;
    WorkReport report;

    explicit EvenWorld(float ground_albedo) {
        small.scene.ground = Ground{0, glm::vec3(ground_albedo)};
        radiance.front.assign(small.scene.patches.size(), glm::vec3(1.f));
        radiance.back = radiance.front;
    }
    LightMapsOfPatches maps(const std::vector<std::uint8_t>& readers) {
        report = {};
        const RayQueries queries(small.scene);
        return make_patch_light_maps(queries, small.tree, readers, constant_environment(glm::vec3(1.f)), radiance, {},
                                     silent_progress(), report);
    }
    std::vector<std::uint8_t> all() const { return std::vector<std::uint8_t>(small.scene.patches.size(), 1); }
    std::uint64_t captured() const { return report.counts.empty() ? 0 : report.counts.front().value; }
};

TEST(PatchLightMaps, HaveAllThatArrives) {
    EvenWorld bright(1);
    const LightMapsOfPatches maps = bright.maps(bright.all());
    ASSERT_EQ(maps.maps.size(), 15u);
    for (const LightMap& map : maps.maps)
        for (const glm::vec3& direction : {glm::vec3(0, 1, 0), glm::vec3(0, -1, 0), glm::vec3(0.6f, 0, 0.8f)})
            EXPECT_NEAR(sh_radiance(map.coefficients, direction).g, 1, 0.01);
    EvenWorld black(0);
    double below = 0;
    for (const LightMap& map : black.maps(black.all()).maps) {
        EXPECT_NEAR(sh_radiance(map.coefficients, {0, 1, 0}).g, 1, 0.05);
        below += double(sh_radiance(map.coefficients, {0, -1, 0}).g) / 15;
    }
    EXPECT_LT(below, 0.8);
}

TEST(PatchLightMaps, AreMadeForThoseWhoReadThem) {
    EvenWorld world(0.3f);
    const LightMapsOfPatches every = world.maps(world.all());
    EXPECT_EQ(world.captured(), 15u);
    EXPECT_TRUE(world.report.skips.empty());
    std::vector<std::uint8_t> one(world.small.scene.patches.size(), 0);
    EXPECT_TRUE(world.maps(one).empty());
    EXPECT_EQ(world.captured(), 0u);

    one[7] = 1;
    const LightMapsOfPatches few = world.maps(one);
    EXPECT_EQ(world.captured(), few.maps.size());
    ASSERT_EQ(few.maps.size(), 4u);
    ASSERT_EQ(world.report.skips.size(), 1u);
    EXPECT_EQ(world.report.skips[0].saved, "11 of 15 maps");
    for (std::size_t k = 0; k < few.per_patch; ++k) {
        const LightMapShare share = few.of(7)[k], same = every.of(7)[k];
        EXPECT_EQ(share.share, same.share);
        EXPECT_EQ(few.maps[share.map].position, every.maps[same.map].position);
        EXPECT_EQ(few.maps[share.map].coefficients, every.maps[same.map].coefficients);
        EXPECT_EQ(few.of(8)[k].share, 0);
    }
}

} // namespace
} // namespace kokage
