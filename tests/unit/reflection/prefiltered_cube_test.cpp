#include "common/directions/sphere_sets.h"
#include "common/services/error.h"
#include "reflection/maps/prefiltered_cube.h"

#include <gtest/gtest.h>
#include <set>

namespace kokage {
namespace {

PrefilteredCube::Level level_of_directions(int size) {
    PrefilteredCube::Level level;
    level.size = size;
    for (int face = 0; face < 6; ++face)
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x)
                level.texels.emplace_back(cube_texel_direction(face, x, y, size));
    return level;
}

/// OpenGL 4.6, section 8.13, table 8.19, written out: major axis, then sc, tc, ma.
TEST(PrefilteredCube, FacesAreLaidOutAsOpenGlsTableSays) {
    for (const glm::dvec3& r : fibonacci_sphere(5000).directions) {
        const glm::dvec3 a = glm::abs(r);
        int face;
        double sc, tc, ma;
        if (a.x > a.y && a.x > a.z) {
            face = r.x > 0 ? 0 : 1;
            sc = r.x > 0 ? -r.z : r.z;
            tc = -r.y;
            ma = r.x;
        } else if (a.y > a.z) {
            face = r.y > 0 ? 2 : 3;
            sc = r.x;
            tc = r.y > 0 ? r.z : -r.z;
            ma = r.y;
        } else {
            face = r.z > 0 ? 4 : 5;
            sc = r.z > 0 ? r.x : -r.x;
            tc = -r.y;
            ma = r.z;
        }
        const int size = 32;
        const int x = int((sc / std::abs(ma) + 1) / 2 * size), y = int((tc / std::abs(ma) + 1) / 2 * size);
        EXPECT_EQ(cube_texel_towards(r, size), std::size_t((face * size + y) * size + x));
        EXPECT_GT(glm::dot(cube_texel_direction(face, x, y, size), r), std::cos(1.5 / size));
    }
}

TEST(PrefilteredCube, SolidAnglesSumToTheSphere) {
    double sum = 0;
    for (int y = 0; y < 37; ++y)
        for (int x = 0; x < 37; ++x)
            sum += cube_texel_solid_angle(x, y, 37);
    EXPECT_NEAR(6 * sum, 4 * kPiDouble, 1e-12);
    for (const int size : {1, 2, 3, 8, 37}) {
        const std::vector<double> all = cube_texel_solid_angles(size);
        ASSERT_EQ(all.size(), std::size_t(size * size));
        for (int i = 0; i < size * size; ++i)
            EXPECT_NEAR(all[std::size_t(i)] / cube_texel_solid_angle(i % size, i / size, size), 1, 1e-12);
    }
}

TEST(PrefilteredCube, NeighboursAcrossEveryEdgeLieSideBySide) {
    for (const int size : {1, 2, 5, 16, 256}) {
        std::set<std::pair<std::size_t, std::size_t>> pairs;
        for (int face = 0; face < 6; ++face)
            for (int i = 0; i < size; ++i)
                for (const auto& [x, y, inner_x, inner_y] :
                     {std::array{-1, i, 0, i}, std::array{size, i, size - 1, i}, std::array{i, -1, i, 0},
                      std::array{i, size, i, size - 1}}) {
                    const std::size_t inner = cube_texel_index(face, inner_x, inner_y, size);
                    const std::size_t outer = cube_texel_index(face, x, y, size);
                    EXPECT_NE(inner / std::size_t(size * size), outer / std::size_t(size * size));
                    pairs.insert({inner, outer});
                    // The edge's point between them is as far from either.
                    auto direction = [&](std::size_t at) {
                        return cube_texel_direction(int(at) / size / size, int(at) % size, int(at) / size % size, size);
                    };
                    const glm::dvec3 between = direction(inner) + direction(outer);
                    const glm::dvec3 a = glm::abs(between);
                    const double largest = std::max({a.x, a.y, a.z});
                    const int on_edge = (a.x > largest - 1e-9) + (a.y > largest - 1e-9) + (a.z > largest - 1e-9);
                    EXPECT_EQ(on_edge, 2) << size;
                }
        for (const auto& [inner, outer] : pairs) // each is the other's neighbour
            EXPECT_TRUE(pairs.contains({outer, inner}));
        EXPECT_EQ(pairs.size(), std::size_t(24 * size));
    }
}

TEST(PrefilteredCube, LookupMeetsTexelsAndIsContinuousEverywhere) {
    const PrefilteredCube::Level level = level_of_directions(16);
    for (int face = 0; face < 6; ++face)
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 16; ++x) {
                const glm::dvec3 d = cube_texel_direction(face, x, y, 16);
                EXPECT_LT(glm::distance(glm::dvec3(cube_lookup(level, 5. * d)), d), 1e-6);
            }
    for (const glm::dvec3& d : fibonacci_sphere(4000).directions)
        EXPECT_LT(glm::distance(glm::dvec3(cube_lookup(level, d)), d), 0.02);
    // Across each edge and at each corner, the two sides agree.
    const double tiny = 1e-7;
    for (int axis = 0; axis < 3; ++axis)
        for (const double sign_a : {-1., 1.})
            for (const double sign_b : {-1., 1.})
                for (double along = -1; along <= 1; along += 1 / 64.) {
                    glm::dvec3 inner, outer;
                    inner[axis] = outer[axis] = along;
                    inner[(axis + 1) % 3] = sign_a * (1 + tiny);
                    outer[(axis + 1) % 3] = sign_a;
                    inner[(axis + 2) % 3] = sign_b;
                    outer[(axis + 2) % 3] = sign_b * (1 + tiny);
                    EXPECT_LT(glm::distance(cube_lookup(level, inner), cube_lookup(level, outer)), 1e-5f);
                }
}

TEST(PrefilteredCube, LevelsAreBlendedLinearly) {
    PrefilteredCube cube = empty_cube({.size = 2, .parameters = {0.5, 1}});
    std::fill(cube.levels[0].texels.begin(), cube.levels[0].texels.end(), glm::vec3(1.f));
    std::fill(cube.levels[1].texels.begin(), cube.levels[1].texels.end(), glm::vec3(3.f));
    for (const auto& [lod, wanted] : {std::pair{-1., 1.f}, {0., 1.f}, {0.25, 1.5f}, {1., 3.f}, {7., 3.f}})
        EXPECT_FLOAT_EQ(cube_lookup(cube, {0.3, -0.2, 0.9}, lod).g, wanted);
}

TEST(PrefilteredCube, RoughnessRulesAreTheirProgramsOwn) {
    EXPECT_EQ(even_roughness(5), (std::vector<double>{0, 0.25, 0.5, 0.75, 1}));
    EXPECT_EQ(even_roughness(1), std::vector<double>{0});
    const std::vector<double> filament = filament_roughness(5);
    // What `cmgen` prints as perceptual roughness for a cube of 256.
    const std::vector<double> printed = {0, 0.134, 0.293, 0.5, 1};
    ASSERT_EQ(filament.size(), printed.size());
    for (std::size_t i = 0; i < printed.size(); ++i)
        EXPECT_NEAR(filament[i], printed[i], 5e-4);
    EXPECT_EQ(usual_level_count(256), 5);
    for (const auto& [size, levels] : {std::pair{512, 6}, {64, 5}, {16, 5}, {8, 4}, {7, 1}})
        EXPECT_EQ(usual_level_count(size), levels) << size;
}

TEST(PrefilteredCube, TheLayoutHoldsTheFilteredLevelsInOrder) {
    const PrefilteredCube cube = empty_cube({.size = 8, .parameters = {0, 0.3, 1}});
    EXPECT_TRUE(cube.levels[0].unfiltered);
    const TexelLayout layout = filtered_layout(cube);
    ASSERT_EQ(layout.size(), std::size_t(6 * (16 + 4)));
    EXPECT_EQ(layout.kind, LobeKind::ggx);
    EXPECT_FLOAT_EQ(layout.parameters[95], 0.3f);
    EXPECT_FLOAT_EQ(layout.parameters[96], 1.f);
    EXPECT_LT(glm::distance(glm::dvec3(layout.directions[96 + 4]), cube_texel_direction(1, 0, 0, 2)), 1e-6);
    const TexelLayout phong =
        filtered_layout(empty_cube({.size = 4, .kind = LobeKind::phong, .parameters = {HUGE_VAL, 100}}));
    EXPECT_EQ(phong.size(), 24u);
    EXPECT_EQ(phong.kind, LobeKind::phong);
    EXPECT_FLOAT_EQ(phong.parameters[0], 100.f);
}

TEST(PrefilteredCube, SettingsThatMakeNoCubeAreRefused) {
    for (const auto& [settings, words] : std::initializer_list<std::pair<CubeSettings, std::string>>{
             {{.size = 0, .parameters = {0}}, "1 to 16384"},
             {{.size = 20000, .parameters = {0}}, "1 to 16384"},
             {{.size = 16, .parameters = {}}, "no level"},
             {{.size = 12, .parameters = {0, 1}}, "power of two"},
             {{.size = 4, .parameters = {0, 0.2, 0.5, 1}}, "4 levels are more"},
             {{.size = 16, .parameters = {0.5, 0}}, "only level 0"},
             {{.size = 16, .parameters = {0, 1.5}}, "roughness 1.5"},
             {{.size = 16, .parameters = {std::nan("")}}, "roughness nan"},
             {{.size = 16, .kind = LobeKind::phong, .parameters = {-1}}, "exponent -1"}}) {
        try {
            empty_cube(settings);
            ADD_FAILURE() << words;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
        }
    }
}

} // namespace
} // namespace kokage
