// Levels of detail: area, place and light of the leaves, and what is left of the bark.
#include "common/services/error.h"
#include "common/services/random.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tree_files.h"
#include "tests/unit/trees/growth_shape.h"
#include "trees/growth.h"
#include "trees/levels_of_detail.h"
#include "trees/patches.h"
#include "trees/read_tree.h"

#include <gtest/gtest.h>
#include <map>

namespace kokage {
namespace {

Tree grown_leafy(const char* species, int leaves = 6000) {
    GrowthParameters p = find_species(species).parameters;
    p.leaves = leaves;
    return grow(p);
}

/// Some light, different on every side.
ShadedAttributes noise_light(const Tree& tree) {
    ShadedAttributes light;
    Random random(5);
    for (std::size_t i = 0; i < tree.leaves.size() + tree.bark_patch_count; ++i) {
        light.radiance_front.push_back({random.uniform(), random.uniform(), random.uniform()});
        light.radiance_back.push_back({random.uniform(), random.uniform(), random.uniform()});
    }
    light.indirect_front = light.radiance_back;
    light.indirect_back = light.radiance_front;
    return light;
}

std::vector<double> areas_of(const Tree& tree) {
    return solid_areas(make_patches(tree));
}

std::size_t triangles_of(const Tree& tree, TreePartKind kind) {
    std::size_t count = 0;
    for (const TreePart& part : tree.parts)
        count += part.kind == kind ? part.triangles.size() : 0;
    return count;
}

TEST(LevelsOfDetail, KeepLeafAreaAndHaveFewerLeavesAndTriangles) {
    for (const char* species : {"oak", "spruce", "aspen"}) {
        const Tree full = grown_leafy(species);
        const LevelOfDetail zero = level_of_detail(full, 0);
        EXPECT_EQ(zero.tree.leaves.size(), full.leaves.size());
        std::size_t group = 1, bark = triangles_of(full, TreePartKind::bark);
        const std::size_t all_bark = bark;
        for (int level = 1; level <= 3; ++level) {
            group *= std::size_t(detail_ratio);
            const LevelOfDetail lod = level_of_detail(full, level);
            EXPECT_NEAR(lod.leaf_area, zero.leaf_area, 0.01 * zero.leaf_area) << species << ", level " << level;
            EXPECT_EQ(lod.tree.leaves.size(), (full.leaves.size() + group - 1) / group) << species;
            EXPECT_TRUE(is_sound(lod.tree));
            EXPECT_NO_THROW(validate(make_patches(lod.tree)));
            const std::size_t coarser = triangles_of(lod.tree, TreePartKind::bark);
            EXPECT_LT(coarser, bark) << species;
            EXPECT_LT(double(coarser), 1.3 * double(all_bark) / double(group) + 60) << species << ", level " << level;
            EXPECT_GT(coarser, 0u);
            bark = coarser;
        }
    }
}

// The height and distance from the trunk at which a tenth, half and nine tenths of the leaf area lie.
TEST(LevelsOfDetail, KeepTheLeavesDistributionInSpace) {
    const Tree full = grown_leafy("oak");
    const auto quantiles = [](const Tree& tree, const auto& measure) {
        const std::vector<double> areas = areas_of(tree);
        std::vector<std::pair<double, double>> values;
        double total = 0;
        for (std::size_t i = 0; i < tree.leaves.size(); ++i) {
            values.emplace_back(measure(tree.leaves[i].centre), areas[i]);
            total += areas[i];
        }
        std::sort(values.begin(), values.end());
        std::vector<double> result;
        double sum = 0;
        for (const auto& [value, area] : values) {
            const double before = sum / total;
            sum += area;
            for (const double q : {0.1, 0.5, 0.9})
                if (before < q && sum / total >= q)
                    result.push_back(value);
        }
        return result;
    };
    const double radius = measure_crown(full).width / 2;
    for (int level = 1; level <= 3; ++level) {
        const Tree coarse = level_of_detail(full, level).tree;
        const auto height = [](const glm::vec3& p) { return double(p.y); };
        const auto reach = [](const glm::vec3& p) { return double(std::hypot(p.x, p.z)); };
        for (int q = 0; q < 3; ++q) {
            EXPECT_NEAR(quantiles(coarse, height)[std::size_t(q)], quantiles(full, height)[std::size_t(q)],
                        0.05 * radius);
            EXPECT_NEAR(quantiles(coarse, reach)[std::size_t(q)], quantiles(full, reach)[std::size_t(q)],
                        0.05 * radius);
        }
        EXPECT_NEAR(measure_crown(coarse).mean_inclination_degrees, measure_crown(full).mean_inclination_degrees, 4)
            << "leaves stand as they stood";
    }
}

// What is seen of a bare tree is its bark's area: without growth a birch's levels have 59, 41 and 28 % of it.
TEST(LevelsOfDetail, KeepBarkAreaInSummerAndWinter) {
    const auto reach = [](const Tree& tree) {
        double furthest = 0;
        for (const TreePart& part : tree.parts)
            for (const glm::vec3& p : part.positions)
                furthest = std::max(furthest, double(std::hypot(p.x, p.z)));
        return furthest;
    };
    for (const char* species : {"oak", "spruce", "birch"})
        for (const Season season : {Season::summer, Season::winter}) {
            GrowthParameters p = find_species(species).parameters;
            p.leaves = 15000;
            p.season = season;
            const Tree full = grow(p);
            const double area = level_of_detail(full, 0).bark_area;
            for (int level = 1; level <= 3; ++level) {
                const LevelOfDetail lod = level_of_detail(full, level);
                // The slow twin: triangle by triangle, from the positions that are written.
                double sum = 0;
                for (const TreePart& part : lod.tree.parts)
                    if (part.kind == TreePartKind::bark)
                        for (const glm::uvec3& t : part.triangles)
                            sum += 0.5 * glm::length(glm::cross(
                                             glm::dvec3(part.positions[t.y]) - glm::dvec3(part.positions[t.x]),
                                             glm::dvec3(part.positions[t.z]) - glm::dvec3(part.positions[t.x])));
                EXPECT_NEAR(sum, area, 0.1 * area) << species << ", level " << level;
                EXPECT_NEAR(lod.bark_area, area, 0.1 * area) << species << ", level " << level;
                EXPECT_TRUE(is_sound(lod.tree));
                EXPECT_NEAR(reach(lod.tree), reach(full), 0.25 * reach(full)) << species << ", level " << level;
            }
        }
}

TEST(LevelsOfDetail, EveryLeafIsStoodForByOneNearIt) {
    const Tree full = grown_leafy("oak");
    const LevelOfDetail lod = level_of_detail(full, 2);
    std::map<std::uint32_t, int> group_size;
    double furthest = 0;
    for (std::size_t i = 0; i < full.leaves.size(); ++i) {
        ASSERT_LT(lod.stands_for[i], lod.tree.leaves.size());
        ++group_size[lod.stands_for[i]];
        furthest =
            std::max(furthest, double(glm::distance(full.leaves[i].centre, lod.tree.leaves[lod.stands_for[i]].centre)));
    }
    EXPECT_EQ(group_size.size(), lod.tree.leaves.size());
    for (const auto& [leaf, size] : group_size)
        EXPECT_LE(size, 9);
    EXPECT_LT(furthest, 0.25 * measure_crown(full).width);
}

// The slow twin: sums over groups, one group at a time.
TEST(LevelsOfDetail, SidesHaveTheMeanLightOfThoseTheyStandFor) {
    const Tree full = grown_leafy("beech", 1500);
    const ShadedAttributes light = noise_light(full);
    const std::vector<double> areas = areas_of(full);
    for (int level = 1; level <= 3; ++level) {
        const LevelOfDetail lod = level_of_detail(full, level);
        const ShadedAttributes coarse = transfer_light(full, light, lod);
        ASSERT_EQ(coarse.radiance_front.size(), lod.tree.leaves.size() + lod.tree.bark_patch_count);
        for (std::size_t to = 0; to < coarse.radiance_front.size(); to += 7) {
            glm::dvec3 front(0.0), back(0.0);
            double weight = 0;
            for (std::size_t i = 0; i < areas.size(); ++i)
                if (lod.stands_for[i] == to) {
                    const bool turned = lod.turned[i] != 0;
                    front += areas[i] * glm::dvec3(turned ? light.radiance_back[i] : light.radiance_front[i]);
                    back += areas[i] * glm::dvec3(turned ? light.radiance_front[i] : light.radiance_back[i]);
                    weight += areas[i];
                }
            ASSERT_GT(weight, 0);
            for (std::size_t c = 0; c < 3; ++c) {
                EXPECT_NEAR(coarse.radiance_front[to][c], front[c] / weight, 1e-5);
                EXPECT_NEAR(coarse.radiance_back[to][c], back[c] / weight, 1e-5);
            }
        }
        // Light that leaves send out in all: area x radiance, both sides.
        const std::vector<double> coarse_areas = areas_of(lod.tree);
        glm::dvec3 before(0.0), after(0.0);
        for (std::size_t i = 0; i < full.leaves.size(); ++i)
            before += areas[i] * glm::dvec3(light.radiance_front[i] + light.radiance_back[i]);
        for (std::size_t i = 0; i < lod.tree.leaves.size(); ++i)
            after += coarse_areas[i] * glm::dvec3(coarse.radiance_front[i] + coarse.radiance_back[i]);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(after[c], before[c], 1e-3 * before[c]) << "level " << level;
    }
}

TEST(LevelsOfDetail, FrontsThatLookAwayFromOneAnotherAreTurned) {
    // Two leaves at one place, one upside down: the light from above falls on the first's front and the other's back.
    Tree tree;
    tree.name = "two";
    tree.materials.resize(1);
    tree.parts.resize(1);
    TreePart& part = tree.parts[0];
    part.kind = TreePartKind::foliage;
    part.positions = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 0.1f, 0}, {1, 0.1f, 0}, {0, 0.1f, 1}};
    part.normals = {{0, 1, 0}, {0, 1, 0}, {0, 1, 0}, {0, -1, 0}, {0, -1, 0}, {0, -1, 0}};
    part.triangles = {{0, 1, 2}, {3, 4, 5}};
    part.triangle_patch = {0, 1};
    tree.leaves.resize(2);
    ShadedAttributes light;
    light.radiance_front = {glm::vec3(1), glm::vec3(0)};
    light.radiance_back = {glm::vec3(0), glm::vec3(1)};
    const LevelOfDetail lod = level_of_detail(tree, 1);
    ASSERT_EQ(lod.tree.leaves.size(), 1u);
    EXPECT_NEAR(lod.leaf_area, 1.0, 1e-6);
    const ShadedAttributes coarse = transfer_light(tree, light, lod);
    const bool first_stays = lod.turned[0] == 0;
    EXPECT_NE(lod.turned[0], lod.turned[1]);
    EXPECT_EQ(first_stays ? coarse.radiance_front[0] : coarse.radiance_back[0], glm::vec3(1));
    EXPECT_EQ(first_stays ? coarse.radiance_back[0] : coarse.radiance_front[0], glm::vec3(0));
}

TEST(LevelsOfDetail, AreWrittenAndReadBack) {
    const TemporaryFolder folder;
    const Tree full = grown_leafy("birch", 900);
    const LevelOfDetail lod = level_of_detail(full, 2);
    const ShadedAttributes light = transfer_light(full, noise_light(full), lod);
    write_tree(folder / "lod.glb", lod.tree, &light);
    const Tree read = read_tree(folder / "lod.glb");
    EXPECT_EQ(read.leaves.size(), 100u);
    EXPECT_EQ(read.bark_patch_count, lod.tree.bark_patch_count);
    EXPECT_EQ(read_shaded(folder / "lod.glb").radiance_front, light.radiance_front);
}

TEST(LevelsOfDetail, KeepLeafAreaOfOtherProgramsTrees) {
    const auto data = data_folder();
    if (!data)
        GTEST_SKIP() << "skipped: KOKAGE_DATA is not set";
    for (const char* name : {"eztree_ash_large", "quaternius_tex_birch_8", "quaternius_common_tree_1"}) {
        const Tree full = read_tree(*data / "trees" / (std::string(name) + ".glb"));
        const double area = level_of_detail(full, 0).leaf_area;
        for (int level = 1; level <= 3; ++level)
            EXPECT_NEAR(level_of_detail(full, level).leaf_area, area, 0.01 * area) << name << ", level " << level;
    }
}

TEST(LevelsOfDetail, TakeTreesOfAnyKind) {
    for (const int leaves : {1, 2, 10}) {
        const Tree tiny = grown_leafy("oak", leaves);
        for (int level = 0; level <= 8; ++level) {
            const LevelOfDetail lod = level_of_detail(tiny, level);
            EXPECT_GE(lod.tree.leaves.size(), 1u);
            EXPECT_TRUE(is_sound(lod.tree));
            EXPECT_NO_THROW(transfer_light(tiny, noise_light(tiny), lod));
        }
    }
    GrowthParameters winter = oak_parameters();
    winter.leaves = 500;
    winter.season = Season::winter;
    const Tree bare = grow(winter);
    const LevelOfDetail lod = level_of_detail(bare, 2);
    EXPECT_TRUE(lod.tree.leaves.empty());
    EXPECT_GT(lod.bark_area, 0);
    EXPECT_NO_THROW(level_of_detail(Tree(), 1));
    EXPECT_THROW(level_of_detail(bare, 9), InputError);
    EXPECT_THROW(level_of_detail(bare, -1), InputError);
    EXPECT_THROW(transfer_light(bare, ShadedAttributes(), lod), InputError);
}

} // namespace
} // namespace kokage
