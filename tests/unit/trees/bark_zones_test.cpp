// Bark in zones: which wood is twig, old or young, and that cutting it up loses nothing.
#include "tests/unit/trees/growth_shape.h"
#include "trees/growth.h"
#include "trees/growth/bark_image.h"
#include "trees/growth/bark_zones.h"
#include "trees/patches.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <set>

namespace kokage {
namespace {

Tree grown_with_zones(const char* species) {
    GrowthParameters p = find_species(species).parameters;
    p.leaves = 12000;
    return grow(p);
}

TEST(BarkZones, TwigsAreThinAndOnlySomeTrunksAge) {
    GrowthParameters p;
    p.bark = BarkKind::birch;
    const auto zone = [&](float radius, float height, bool trunk) {
        return bark_zone({.radius_m = radius, .height_m = height, .on_trunk = trunk}, p, 0.1f, 10, 1);
    };
    EXPECT_TRUE(zone(0.003f, 5, false).is_twig);
    EXPECT_FALSE(zone(0.03f, 5, false).is_twig);
    EXPECT_EQ(zone(0.1f, 0, true).age, 1.f) << "black at the foot";
    EXPECT_EQ(zone(0.1f, 5, true).age, 0.f) << "white above";
    EXPECT_EQ(zone(0.05f, 0.1f, false).age, 0.f) << "limbs are young";
    p.bark = BarkKind::beech;
    EXPECT_EQ(zone(0.1f, 0, true), zone(0.05f, 9, false)) << "a beech is the same all over";
    // A sapling's trunk is no twig, however thin.
    EXPECT_FALSE(bark_zone({.radius_m = 0.004f, .height_m = 0.1f, .on_trunk = true}, p, 0.004f, 0.5f, 0).is_twig);
}

TEST(BarkZones, CutWholePatchesAndLoseNothing) {
    for (const char* species : {"birch", "pine", "oak"}) {
        const Tree tree = grown_with_zones(species);
        std::set<std::uint32_t> seen, materials;
        std::size_t zones = 0;
        for (const TreePart& part : tree.parts) {
            if (part.kind != TreePartKind::bark)
                continue;
            ++zones;
            EXPECT_TRUE(materials.insert(part.material).second);
            std::set<std::uint32_t> own(part.triangle_patch.begin(), part.triangle_patch.end());
            for (const std::uint32_t patch : own)
                EXPECT_TRUE(seen.insert(patch).second) << "a patch lies in one zone";
        }
        EXPECT_EQ(seen.size(), tree.bark_patch_count);
        EXPECT_EQ(*seen.rbegin() + 1, tree.bark_patch_count);
        const std::size_t least = std::string(species) == "oak" ? 2 : 5, most = std::string(species) == "oak" ? 2 : 8;
        EXPECT_GE(zones, least) << species;
        EXPECT_LE(zones, most) << species;
        EXPECT_EQ(tree.materials.size(), zones + 1);
        EXPECT_TRUE(is_sound(tree));
        EXPECT_NO_THROW(validate(make_patches(tree)));
    }
}

TEST(BarkZones, APinesTrunkHasAllSevenAges) {
    const Tree tree = grow(find_species("pine").parameters);
    std::size_t zones = 0;
    for (const TreePart& part : tree.parts)
        zones += part.kind == TreePartKind::bark;
    EXPECT_EQ(zones, 7u + 1u) << "with the twigs";
}

TEST(BarkZones, ABirchIsWhiteAboveAndDarkAtItsFoot) {
    const Tree tree = grown_with_zones("birch");
    const PatchScene scene = make_patches(tree);
    float foot = 0, above = 0;
    std::size_t foot_count = 0, above_count = 0;
    for (std::size_t i = scene.leaf_count; i < scene.patches.size(); ++i) {
        const Patch& patch = scene.patches[i];
        const glm::vec3 at = scene.positions[scene.triangles[patch.first_triangle].x];
        const float level = luminance(scene.optics[patch.optics].reflectance);
        if (at.y < 0.02f) {
            foot += level;
            ++foot_count;
        } else if (level > 0.4f) {
            above += level;
            ++above_count;
        }
    }
    ASSERT_GT(foot_count, 0u);
    ASSERT_GT(above_count, 20u);
    EXPECT_LT(foot / float(foot_count), 0.5f * above / float(above_count));
}

} // namespace
} // namespace kokage
