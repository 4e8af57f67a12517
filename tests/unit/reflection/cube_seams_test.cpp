// No visible step across a cube's edges and corners, at any level: what lies on both sides of an edge differs no more,
// and bends no more, than neighbours inside of a face.
#include "reflection/maps/prefiltered_cube.h"
#include "reflection/maps/spectral_baker.h"

#include <gtest/gtest.h>
#include <random>

namespace kokage {
namespace {

/// Hard edges everywhere, some very bright, two of them at corners of the cube and one on an edge.
Environment harsh_surroundings() {
    Environment environment;
    environment.remainder = Image(128, 64, 3);
    std::mt19937 random(5);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 128; ++x)
            for (int c = 0; c < 3; ++c) {
                const glm::dvec3 d = pixel_direction(x, y, 128, 64);
                float value = ((x / 9 + y / 7) % 2 == 0 ? 0.9f : 0.1f) + 0.1f * float(random() % 100) / 100;
                for (const glm::dvec3& lamp : {glm::dvec3(1, 1, 1), glm::dvec3(-1, 1, -1), glm::dvec3(0, 1, 1)})
                    if (glm::dot(d, glm::normalize(lamp)) > 0.997)
                        value += 40;
                environment.remainder.at(x, y)[c] = value;
            }
    return environment;
}

/// How large the largest and the mean are, of differences per angle and of steps: the difference of what the two sides'
/// own slopes lead to expect half-way.
struct Roughness {
    double largest_slope = 0, mean_slope = 0, largest_step = 0, mean_step = 0;
    int count = 0;

    void add(const std::array<glm::dvec3, 4>& values, double angle) {
        const double slope = glm::length(values[1] - values[2]) / angle;
        const double step = glm::length(1.5 * values[1] - 0.5 * values[0] - (1.5 * values[2] - 0.5 * values[3]));
        largest_slope = std::max(largest_slope, slope);
        largest_step = std::max(largest_step, step);
        mean_slope = (mean_slope * count + slope) / (count + 1);
        mean_step = (mean_step * count + step) / (count + 1);
        ++count;
    }
};

struct Seams {
    Roughness inside, across;
};

Seams measure(const PrefilteredCube::Level& level) {
    const int n = level.size;
    auto value = [&](std::size_t at) { return glm::dvec3(level.texels[at]); };
    auto direction = [&](std::size_t at) {
        return cube_texel_direction(int(at) / n / n, int(at) % n, int(at) / n % n, n);
    };
    Seams seams;
    for (int face = 0; face < 6; ++face)
        for (int row = 0; row < n; ++row)
            for (const bool turned : {false, true}) {
                auto at = [&](int i) { return cube_texel_index(face, turned ? row : i, turned ? i : row, n); };
                auto angle = [&](std::size_t a, std::size_t b) {
                    return std::acos(glm::dot(direction(a), direction(b)));
                };
                for (int i = 1; i + 2 < n; ++i)
                    seams.inside.add({value(at(i - 1)), value(at(i)), value(at(i + 1)), value(at(i + 2))},
                                     angle(at(i), at(i + 1)));
                for (const int side : {0, n - 1}) {
                    const int inner = side == 0 ? 1 : n - 2, beyond = side == 0 ? -1 : n;
                    // Two beyond: the neighbour's own neighbour straight on, the one that is farthest from `side`.
                    const std::size_t next = at(beyond);
                    const int next_face = int(next) / n / n, x = int(next) % n, y = int(next) / n % n;
                    std::size_t farther = next;
                    for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
                        const int fx = x + dx, fy = y + dy;
                        if (fx < 0 || fx >= n || fy < 0 || fy >= n)
                            continue;
                        const std::size_t candidate = cube_texel_index(next_face, fx, fy, n);
                        if (angle(candidate, at(side)) > angle(farther, at(side)) + 1e-9)
                            farther = candidate;
                    }
                    seams.across.add({value(at(inner)), value(at(side)), value(next), value(farther)},
                                     angle(at(side), next));
                }
            }
    return seams;
}

PrefilteredCube baked(const Environment& environment) {
    PrefilteredCube cube = empty_cube({.size = 64, .parameters = {0, 0.2, 0.5, 1}});
    WorkReport report;
    const auto baker = spectral_baker(filtered_layout(cube), 128, 64, {}, report);
    bake_cube(cube, environment, baker.get(), report);
    return cube;
}

TEST(CubeSeams, AllTwelveEdgesAreAsSmoothAsTheFacesAtEveryFilteredLevel) {
    const PrefilteredCube cube = baked(harsh_surroundings());
    for (std::size_t i = 1; i < cube.levels.size(); ++i) {
        const Seams seams = measure(cube.levels[i]);
        EXPECT_EQ(seams.across.count, 24 * cube.levels[i].size) << "each edge from both sides";
        EXPECT_LE(seams.across.largest_slope, 1.05 * seams.inside.largest_slope) << "level " << i;
        EXPECT_LE(seams.across.largest_step, 1.05 * seams.inside.largest_step) << "level " << i;
        EXPECT_LE(seams.across.mean_step, 1.3 * seams.inside.mean_step) << "level " << i;
        RecordProperty("level_" + std::to_string(i) + "_mean_step_across_over_inside",
                       std::to_string(seams.across.mean_step / seams.inside.mean_step));
    }
}

TEST(CubeSeams, TheMeasureTellsAFaceThatLiesWrong) {
    PrefilteredCube cube = baked(harsh_surroundings());
    PrefilteredCube::Level& level = cube.levels[1];
    const int n = level.size;
    const std::vector<glm::vec3> right = level.texels;
    // One face shifted by one texel: far less than a face that is mirrored or turned.
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x)
            level.texels[cube_texel_index(2, x, y, n)] = right[cube_texel_index(2, std::min(x + 1, n - 1), y, n)];
    const Seams shifted = measure(level);
    EXPECT_GT(shifted.across.mean_step, 1.3 * shifted.inside.mean_step);
}

TEST(CubeSeams, AtTheEightCornersThreeTexelsAgree) {
    const PrefilteredCube cube = baked(harsh_surroundings());
    for (std::size_t i = 1; i < cube.levels.size(); ++i) {
        const PrefilteredCube::Level& level = cube.levels[i];
        const int n = level.size;
        const Seams seams = measure(level);
        for (int corner = 0; corner < 8; ++corner) {
            const glm::dvec3 c(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
            std::array<std::size_t, 3> texels;
            for (int axis = 0; axis < 3; ++axis) {
                glm::dvec3 inwards = c; // just inside of the face of this axis
                inwards[axis] *= 1 + 0.1 / n;
                texels[std::size_t(axis)] = cube_texel_towards(inwards, n);
            }
            for (const auto& [a, b] : {std::pair{0u, 1u}, {1u, 2u}, {0u, 2u}}) {
                ASSERT_NE(texels[a], texels[b]);
                auto direction = [&](std::size_t at) {
                    return cube_texel_direction(int(at) / n / n, int(at) % n, int(at) / n % n, n);
                };
                const double angle = std::acos(glm::dot(direction(texels[a]), direction(texels[b])));
                const double difference =
                    glm::length(glm::dvec3(level.texels[texels[a]]) - glm::dvec3(level.texels[texels[b]]));
                EXPECT_LE(difference / angle, 1.05 * seams.inside.largest_slope) << "level " << i;
            }
        }
    }
}

} // namespace
} // namespace kokage
