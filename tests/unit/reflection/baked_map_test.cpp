#include "common/directions/sphere_sets.h"
#include "common/services/error.h"
#include "reflection/maps/baked_map.h"
#include "reflection/maps/brute_force_baker.h"
#include "reflection/maps/cube_file.h"
#include "reflection/maps/map_file.h"
#include "tests/support/temporary_folder.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

Environment stripes() {
    Environment environment;
    environment.remainder = Image(64, 32, 3);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 64; ++x)
            for (int c = 0; c < 3; ++c)
                environment.remainder.at(x, y)[c] = 0.5f + 0.5f * std::sin(0.1f * float(x * (c + 1) + y));
    return environment;
}

std::unique_ptr<BakedMap> baked(const MapSettings& settings, const Environment& environment) {
    std::unique_ptr<BakedMap> map = make_map(settings);
    WorkReport report;
    const auto baker = make_baker(map->layout(), environment.remainder.width, environment.remainder.height,
                                  {.method = BakeMethod::brute_force}, report);
    map->bake(environment, baker.get(), report);
    return map;
}

double truth_error(const Environment& environment, const Lobe& lobe, const glm::vec3& direction,
                   const glm::vec3& value) {
    return glm::distance(glm::dvec3(value),
                         filtered_by_brute_force(environment, lobe, glm::normalize(glm::dvec3(direction))));
}

TEST(BakedMap, ARangeOfShellsIsSmallerAndHoldsTheSameWithinIt) {
    const TemporaryFolder folder;
    MapSettings settings;
    settings.smoothness = SmoothnessRange{0.15, 0.3};
    const Environment environment = stripes();
    const std::unique_ptr<BakedMap> map = baked(settings, environment);
    const std::optional<WorkReport::Skip> saved = saved_by_range(settings);
    ASSERT_TRUE(saved);
    EXPECT_NE(saved->saved.find("became"), std::string::npos);
    EXPECT_FALSE(saved_by_range({}));
    EXPECT_LT(4 * map->bytes(), make_map({})->bytes());
    WorkReport report;
    map->write(folder / "m.exr", "stripes", report);
    const ShellMap shells = std::get<ShellMap>(read_map(folder / "m.exr").map);
    const RoughnessScale scale = scale_of(settings);
    for (double smoothness : {0.15, 0.22, 0.3})
        for (const glm::vec3 direction : {glm::vec3(1, 2, 3), glm::vec3(-3, 0.5f, 1), glm::vec3(0, -1, 0.1f)})
            EXPECT_LT(truth_error(environment, {LobeKind::phong, scale.exponent(smoothness)}, direction,
                                  shells.lookup(glm::normalize(direction), scale.exponent(smoothness))),
                      0.02) // the stripes end at the seam, in a step
                << smoothness;
}

TEST(BakedMap, ARangeOfACubeBakesTheVoxelsThatItsLookupsReadAndNoOthers) {
    const TemporaryFolder folder;
    MapSettings settings;
    settings.container = MapContainer::voxel_cube;
    settings.size = 32;
    const Environment environment = stripes();
    const std::unique_ptr<BakedMap> whole = baked(settings, environment);
    WorkReport report;
    whole->write(folder / "whole.exr", "", report);
    const VoxelCube a = std::get<VoxelCube>(read_map(folder / "whole.exr").map);
    for (const SmoothnessRange range : {SmoothnessRange{0.4, 0.5}, {0, 0}, {0, 0.1}, {0.05, 0.05}, {1, 1}}) {
        settings.smoothness = range;
        const std::unique_ptr<BakedMap> part = baked(settings, environment);
        EXPECT_LT(2 * part->layout().size(), whole->layout().size());
        EXPECT_TRUE(range.smoothest == 1 || 4 * part->bytes() < whole->bytes());
        part->write(folder / "part.exr", "", report);
        const VoxelCube b = std::get<VoxelCube>(read_map(folder / "part.exr").map);
        for (const glm::dvec3& d : fibonacci_sphere(500).directions)
            for (float share : {0.f, 0.5f, 1.f}) {
                const float smoothness = glm::mix(float(range.roughest), float(range.smoothest), share);
                // Voxels are the same; their places are rounded otherwise in a smaller cube.
                ASSERT_LT(glm::distance(a.lookup(glm::vec3(d), smoothness), b.lookup(glm::vec3(d), smoothness)), 2e-5f)
                    << smoothness;
                // What was not baked looks like the nearest that was.
                const float outside = share < 0.5f ? 0.f : 1.f;
                const double nearest = share < 0.5f ? range.roughest : range.smoothest;
                ASSERT_EQ(b.lookup(glm::vec3(d), outside), b.lookup(glm::vec3(d), float(nearest)));
            }
    }
}

TEST(BakedMap, ACubeOfThePapersScaleKeepsItAndIsLookedUpByIt) {
    const TemporaryFolder folder;
    MapSettings settings;
    settings.container = MapContainer::voxel_cube;
    settings.size = 64;
    settings.scale = ScaleRule::paper;
    settings.format = TexelFormat::float_rgb;
    settings.smoothness = SmoothnessRange{0.45, 0.55};
    const Environment environment = stripes();
    WorkReport report;
    baked(settings, environment)->write(folder / "m.exr", "", report);
    const VoxelCube cube = std::get<VoxelCube>(read_map(folder / "m.exr").map);
    EXPECT_EQ(cube.scale().u(), 6.2);
    // Eqs 12 and 13, written out: u/(λ s) = 6.2/32, Λ = 2 ln 256 / ln(1 + (6.2/32)²).
    const double exponent = 2 * std::log(256.0) / std::log(1 + 6.2 * 6.2 / (32.0 * 32.0));
    EXPECT_NEAR(exponent, 301, 1);
    EXPECT_NEAR(double(cube.smoothness(exponent)), 0.5, 1e-6);
    for (const glm::vec3 direction : {glm::vec3(1, 2, 3), glm::vec3(-3, 0.5f, 1)})
        EXPECT_LT(truth_error(environment, {LobeKind::phong, exponent}, direction,
                              cube.lookup(glm::normalize(direction), cube.smoothness(exponent))),
                  0.02);
    settings.lobe = LobeKind::ggx;
    EXPECT_THROW(make_map(settings), InputError);
}

TEST(BakedMap, CubeMapsHoldTheImageAndItsFilteredLevels) {
    const TemporaryFolder folder;
    MapSettings settings;
    settings.container = MapContainer::cube_map;
    settings.lobe = LobeKind::ggx;
    settings.size = 64;
    const Environment environment = stripes();
    WorkReport report;
    baked(settings, environment)->write(folder / "m.ktx2", "", report);
    EXPECT_TRUE(report.warnings.empty());
    const PrefilteredCube cube = read_ktx2(folder / "m.ktx2").cube;
    ASSERT_EQ(cube.levels.size(), 5u);
    EXPECT_TRUE(cube.levels[0].unfiltered);
    EXPECT_EQ(cube.levels[2].parameter, 0.5);
    const glm::dvec3 direction = cube_texel_direction(3, 5, 7, 16);
    const glm::vec3 value = cube.levels[2].texels[(3 * 16 + 7) * 16 + 5];
    EXPECT_LT(truth_error(environment, {LobeKind::ggx, 0.5}, glm::vec3(direction), value), 2e-3);
}

TEST(BakedMap, AskedSizesAndLevelsOfCubeMapsAreKeptWithARange) {
    MapSettings settings;
    settings.container = MapContainer::cube_map;
    settings.lobe = LobeKind::ggx;
    settings.smoothness = SmoothnessRange{0.05, 0.2};
    const MapPlan plan = plan_map(settings);
    EXPECT_LT(plan.bytes, 64 * 64 * 6 * 8 * 2u) << "no larger than its lobes need";
    EXPECT_GE(plan.levels.size(), 5u);
    EXPECT_EQ(plan.levels.front().size, plan.size);
    const RoughnessScale scale = scale_of(settings);
    EXPECT_EQ(plan.levels.front().lobe.parameter, roughness_from_exponent(scale.exponent(0.2)));
    EXPECT_NEAR(plan.levels.back().lobe.parameter, roughness_from_exponent(scale.exponent(0.05)), 1e-12);
    settings.size = 512;
    settings.levels = 3;
    const MapPlan asked = plan_map(settings);
    EXPECT_EQ(asked.size, 512);
    ASSERT_EQ(asked.levels.size(), 3u);
    EXPECT_EQ(asked.levels[2].size, 128);
    settings.size = 0;
    settings.levels = 8;
    EXPECT_EQ(plan_map(settings).size, 128) << "large enough for its levels";
    EXPECT_EQ(make_map(settings)->layout().size(), plan_map(settings).texels);
    // One lobe: one level.
    settings.levels = 0;
    settings.smoothness = SmoothnessRange{0.3, 0.3};
    ASSERT_EQ(plan_map(settings).levels.size(), 1u);
    EXPECT_FALSE(plan_map(settings).levels[0].unfiltered);
    settings.levels = 2;
    EXPECT_THROW(plan_map(settings), InputError);
    // A file with room for so many levels.
    settings = {};
    settings.container = MapContainer::cube_map;
    settings.size = 4096;
    EXPECT_EQ(plan_map(settings).levels.size(), 9u);
    settings.most_levels = 8;
    EXPECT_EQ(plan_map(settings).levels.size(), 8u);
}

TEST(BakedMap, ARangeOfRoughnessIsTheSameAsItsSmoothness) {
    for (const MapContainer container : {MapContainer::shells, MapContainer::voxel_cube, MapContainer::cube_map})
        for (const LobeKind lobe : {LobeKind::phong, LobeKind::ggx}) {
            MapSettings settings;
            settings.container = container;
            settings.lobe = lobe;
            settings.roughness = RoughnessRange{0.2, 0.5};
            const SmoothnessRange smoothness = smoothness_of(settings);
            EXPECT_NEAR(roughness_from_exponent(scale_of(settings).exponent(smoothness.smoothest)), 0.2, 1e-9);
            EXPECT_NEAR(roughness_from_exponent(scale_of(settings).exponent(smoothness.roughest)), 0.5, 1e-9);
            MapSettings same = settings;
            same.roughness.reset();
            same.smoothness = smoothness;
            const MapPlan a = plan_map(settings), b = plan_map(same);
            EXPECT_EQ(a.texels, b.texels);
            ASSERT_EQ(a.levels.size(), b.levels.size());
            for (std::size_t i = 0; i < a.levels.size(); ++i)
                EXPECT_NEAR(a.levels[i].lobe.parameter / b.levels[i].lobe.parameter, 1, 1e-9);
        }
    MapSettings settings;
    settings.container = MapContainer::cube_map;
    settings.lobe = LobeKind::ggx;
    settings.roughness = RoughnessRange{0, 0.4};
    const MapPlan with_image = plan_map(settings);
    ASSERT_EQ(with_image.levels.size(), 5u);
    EXPECT_TRUE(with_image.levels[0].unfiltered);
    EXPECT_NEAR(with_image.levels[1].lobe.parameter, 0.1, 1e-12);
    settings.container = MapContainer::shells;
    EXPECT_THROW(plan_map(settings), InputError) << "shells hold no mirror";
    settings.container = MapContainer::voxel_cube;
    settings.roughness = RoughnessRange{0.05, 0.4};
    EXPECT_THROW(plan_map(settings), InputError) << "voxel cubes end at smoothness 1";
    settings.roughness = RoughnessRange{0.09, 0.4};
    EXPECT_NO_THROW(plan_map(settings));
    for (const RoughnessRange range : {RoughnessRange{0.6, 0.3}, {-0.1, 0.5}, {0.5, 1.5}, {NAN, 0.5}}) {
        settings.roughness = range;
        EXPECT_THROW(plan_map(settings), InputError);
    }
}

TEST(BakedMap, APlanIsWhatTheMapThenHas) {
    for (const MapContainer container : {MapContainer::shells, MapContainer::voxel_cube, MapContainer::cube_map})
        for (const bool range : {false, true})
            for (const TexelFilter filter : {TexelFilter::bilinear, TexelFilter::cubic}) {
                MapSettings settings;
                settings.container = container;
                settings.filter = filter;
                settings.size = container == MapContainer::voxel_cube ? 20
                                : container == MapContainer::cube_map ? 32
                                                                      : 0;
                if (range)
                    settings.smoothness = SmoothnessRange{0.1, 0.3};
                const MapPlan plan = plan_map(settings);
                const std::unique_ptr<BakedMap> map = make_map(settings);
                EXPECT_EQ(plan.texels, map->layout().size());
                EXPECT_GT(plan.peak_bytes, plan.bytes);
                if (container == MapContainer::shells) {
                    EXPECT_EQ(plan.bytes, ShellMap(shell_settings(settings)).bytes());
                }
            }
}

TEST(BakedMap, SaysHowManyTexelsTheFormatCutsOff) {
    const TemporaryFolder folder;
    Environment environment = stripes();
    for (float& value : environment.remainder.pixels)
        value *= 1e6f;
    for (const auto& [container, file] :
         {std::pair(MapContainer::shells, "m.exr"), {MapContainer::cube_map, "m.dds"}}) {
        MapSettings settings;
        settings.container = container;
        settings.size = container == MapContainer::cube_map ? 16 : 0;
        settings.smoothness = SmoothnessRange{0.05, 0.1};
        WorkReport report;
        baked(settings, environment)->write(folder / file, "", report);
        ASSERT_EQ(report.warnings.size(), 1u) << file;
        EXPECT_NE(report.warnings[0].find("--format float"), std::string::npos);
        settings.format = TexelFormat::float_rgb;
        WorkReport of_floats;
        baked(settings, environment)->write(folder / file, "", of_floats);
        EXPECT_TRUE(of_floats.warnings.empty());
    }
}

TEST(BakedMap, SaysWhereTheFormatHasNoDigitsForDimLight) {
    const TemporaryFolder folder;
    Environment environment = stripes();
    for (float& value : environment.remainder.pixels)
        value *= 1e-6f;
    for (const auto& [container, file] : {std::pair(MapContainer::shells, "m.exr"),
                                          {MapContainer::voxel_cube, "m.exr"},
                                          {MapContainer::cube_map, "m.ktx2"}}) {
        MapSettings settings;
        settings.container = container;
        settings.size = container == MapContainer::shells ? 0 : 16;
        settings.smoothness = SmoothnessRange{0.05, 0.1};
        WorkReport report;
        baked(settings, environment)->write(folder / file, "", report);
        ASSERT_EQ(report.warnings.size(), 1u) << file;
        EXPECT_NE(report.warnings[0].find("so dim"), std::string::npos) << report.warnings[0];
        settings.format = TexelFormat::float_rgb;
        WorkReport of_floats;
        baked(settings, environment)->write(folder / file, "", of_floats);
        EXPECT_TRUE(of_floats.warnings.empty());
    }
}

TEST(BakedMap, SurroundingsThatAreTheSameEverywhereAreNotFiltered) {
    Environment environment;
    environment.remainder = Image(8, 4, 3);
    std::fill(environment.remainder.pixels.begin(), environment.remainder.pixels.end(), 0.25f);
    EXPECT_TRUE(is_same_everywhere(environment));
    WorkReport report;
    std::vector<glm::vec3> filtered(5);
    same_everywhere_baker(report)->bake(environment, filtered, report);
    EXPECT_EQ(filtered, std::vector<glm::vec3>(5, glm::vec3(0.25f)));
    EXPECT_EQ(report.skips.size(), 1u);
    environment.remainder.at(3, 2)[2] = 0.26f;
    EXPECT_FALSE(is_same_everywhere(environment));
    environment.remainder.at(3, 2)[2] = 0.25f;
    environment.distant_lights.push_back({});
    EXPECT_FALSE(is_same_everywhere(environment));
}

TEST(BakedMap, RefusesRangesTheWrongWayRound) {
    MapSettings settings;
    for (const SmoothnessRange range : {SmoothnessRange{0.6, 0.3}, {-0.1, 0.5}, {0.5, 1.5}, {NAN, 0.5}}) {
        settings.smoothness = range;
        EXPECT_THROW(make_map(settings), InputError);
    }
}

TEST(MakeBaker, KnowsItsMethodsByName) {
    for (BakeMethod method : {BakeMethod::spectral, BakeMethod::table, BakeMethod::brute_force})
        EXPECT_EQ(bake_method_from_name(bake_method_name(method)), method);
    try {
        bake_method_from_name("magic");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("spectral, table, brute-force"), std::string::npos);
    }
}

} // namespace
} // namespace kokage
