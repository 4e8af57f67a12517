// The path tracer is what everything else is judged by, so it is judged by analytic answers alone.
#include "common/services/error.h"
#include "common/trace/path_tracer.h"
#include "tests/unit/common/scene_builders.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

constexpr int kPaths = 1 << 16;

/// Mean of `paths` low-discrepancy samples at one point.
glm::dvec3 irradiance(const PathTracer& tracer, const glm::vec3& point, const glm::vec3& normal, int paths = kPaths) {
    glm::dvec3 sum(0);
    for (int i = 0; i < paths; ++i) {
        PathNumbers numbers(17, std::uint32_t(i));
        sum += glm::dvec3(tracer.sample_irradiance(point, normal, numbers).total);
    }
    return sum / double(paths);
}

void add_sun(Environment& environment, const glm::vec3& direction, const glm::vec3& strength, float half_angle = 0) {
    DistantLight sun;
    sun.direction = glm::normalize(direction);
    sun.irradiance = strength;
    sun.half_angle = half_angle;
    environment.distant_lights.push_back(sun);
}

void expect_near(const glm::dvec3& value, const glm::dvec3& expected, double relative) {
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(value[c], expected[c], relative * expected[c] + 1e-12) << "channel " << c;
}

const Environment black = constant_environment(glm::vec3(0));

TEST(PathTracer, WhiteFurnaceIsExactOnEveryPath) {
    // Nothing absorbs and all directions send 1, so every single path brings exactly pi, however often it is scattered.
    const Environment environment = constant_environment(glm::vec3(1));
    for (const bool with_ground : {false, true}) {
        PatchScene scene = test::random_crown(2000, 8, {glm::vec3(0.7f), glm::vec3(0.3f)});
        if (with_ground)
            scene.ground = Ground{0, glm::vec3(1)};
        const RayQueries queries(scene);
        PathTracerOptions options;
        options.roulette_after = 1 << 20;
        const PathTracer tracer(queries, environment, options);
        Random random(1);
        for (int i = 0; i < 4000; ++i) {
            const std::size_t t = 2 * std::size_t(random.below(scene.leaf_count));
            const glm::vec3 a = scene.positions[scene.triangles[t].x], b = scene.positions[scene.triangles[t].y],
                            c = scene.positions[scene.triangles[t].z];
            const glm::vec3 normal = glm::normalize(glm::cross(b - a, c - a));
            const auto sample = tracer.sample_irradiance(0.5f * (a + c), i % 2 ? normal : -normal, random);
            EXPECT_NEAR(sample.total.g, kPi, 2e-4f * kPi);
        }
    }
}

TEST(PathTracer, WhiteFurnaceWithRouletteAndMixtureOnAverage) {
    const Environment environment = constant_environment(glm::vec3(1));
    PatchScene scene = test::random_crown(500, 5, {glm::vec3(0.6f), glm::vec3(0.4f)});
    const RayQueries queries(scene);
    const PathTracer tracer(queries, environment);
    expect_near(irradiance(tracer, {0, 2, 0}, {0, 1, 0}), glm::dvec3(kPiDouble), 0.004);
}

/// A cube with inward fronts, one patch, of side 2 around the origin.
PatchScene closed_box(const Optics& optics) {
    PatchScene scene;
    scene.optics = {optics};
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (const float sign : {-1.f, 1.f}) {
            glm::vec3 corner(-1), u(0), v(0);
            corner[axis] = sign;
            u[(axis + 1) % 3] = 2;
            v[(axis + 2) % 3] = 2;
            sign < 0 ? test::add_rectangle(scene, corner, u, v) : test::add_rectangle(scene, corner, v, u);
        }
    return scene;
}

TEST(PathTracer, ClosedBoxFollowsItsGeometricSeries) {
    // A lamp of intensity I gives 4 pi I in all; every bounce keeps the share a of it. So after k bounces the walls'
    // mean irradiance is 4 pi I / area * (1 - a^(k+1)) / (1 - a), whatever the box' shape.
    for (const float albedo : {0.3f, 0.9f}) {
        const PatchScene scene = closed_box({glm::vec3(albedo), glm::vec3(0)});
        const RayQueries queries(scene);
        Environment environment = constant_environment(glm::vec3(100)); // can't get in
        environment.point_lights.push_back({"lamp", {0.3f, -0.2f, 0.5f}, glm::vec3(2)});
        for (const int bounces : {1, 2, 0}) {
            PathTracerOptions options;
            options.max_bounces = bounces;
            const PathTracer tracer(queries, environment, options);
            double mean = 0;
            const int paths = 1 << 17;
            for (int i = 0; i < paths; ++i) {
                PathNumbers numbers(3, std::uint32_t(i));
                const glm::vec2 place = 2.f * numbers.pair() - 1.f;
                const std::size_t axis = std::size_t(i % 6) / 2;
                const float sign = i % 2 ? 1.f : -1.f;
                glm::vec3 point(0), normal(0);
                point[axis] = sign;
                point[(axis + 1) % 3] = place.x;
                point[(axis + 2) % 3] = place.y;
                normal[axis] = -sign;
                mean += double(tracer.sample_irradiance(point, normal, numbers).total.g) / paths;
            }
            const double terms = bounces > 0 ? 1 - std::pow(double(albedo), bounces + 1) : 1;
            const double expected = 4 * kPiDouble * 2 / 24 * terms / (1 - double(albedo));
            EXPECT_NEAR(mean, expected, 0.01 * expected) << "albedo " << albedo << ", bounces " << bounces;
        }
    }
}

/// What a point that faces +Y receives of a constant sky of radiance 1 behind black occluders.
double open_share(const PatchScene& scene, const glm::vec3& point = glm::vec3(0)) {
    const RayQueries queries(scene);
    const Environment environment = constant_environment(glm::vec3(1));
    return irradiance(PathTracer(queries, environment), point, {0, 1, 0}).g / kPiDouble;
}

TEST(PathTracer, FormFactorOfAParallelRectangle) {
    // Howell, catalogue of configuration factors, B-3: element below the corner of a parallel rectangle a x b at
    // distance c.
    PatchScene scene;
    scene.optics.resize(1);
    const double a = 1.5, b = 0.7, c = 0.8, X = a / c, Y = b / c;
    test::add_rectangle(scene, {0, float(c), 0}, {float(a), 0, 0}, {0, 0, float(b)});
    const double factor = (X / std::sqrt(1 + X * X) * std::atan(Y / std::sqrt(1 + X * X)) +
                           Y / std::sqrt(1 + Y * Y) * std::atan(X / std::sqrt(1 + Y * Y))) /
                          (2 * kPiDouble);
    EXPECT_NEAR(1 - open_share(scene), factor, 0.001 * factor);
}

TEST(PathTracer, FormFactorOfAPerpendicularRectangle) {
    // Howell B-5: element at distance c of a perpendicular rectangle, width b along the common edge, height a.
    PatchScene scene;
    scene.optics.resize(1);
    const double a = 1.2, b = 0.9, c = 0.6, X = a / b, Y = c / b;
    test::add_rectangle(scene, {float(c), 0, 0}, {0, float(a), 0}, {0, 0, float(b)});
    const double distance = std::sqrt(X * X + Y * Y);
    const double factor = (std::atan(1 / Y) - Y / distance * std::atan(1 / distance)) / (2 * kPiDouble);
    EXPECT_NEAR(1 - open_share(scene), factor, 0.001 * factor);
}

TEST(PathTracer, FormFactorOfADisc) {
    // Coaxial parallel disc: r^2 / (r^2 + h^2).
    PatchScene scene;
    scene.optics.resize(1);
    const int corners = 720;
    std::vector<glm::vec3> triangles;
    const auto rim = [&](int i) {
        const float angle = 2 * kPi * float(i % corners) / corners;
        return glm::vec3(0.8f * std::cos(angle), 1.1f, 0.8f * std::sin(angle));
    };
    for (int i = 0; i < corners; ++i)
        triangles.insert(triangles.end(), {glm::vec3(0, 1.1f, 0), rim(i), rim(i + 1)});
    test::add_leaf(scene, triangles);
    const double factor = 0.64 / (0.64 + 1.21);
    EXPECT_NEAR(1 - open_share(scene), factor, 0.001 * factor);
}

TEST(PathTracer, IrradianceOfADirectionalLight) {
    const PatchScene scene;
    const RayQueries queries(scene);
    Environment environment = black;
    add_sun(environment, {3, 4, 0}, {2, 3, 5});
    expect_near(irradiance(PathTracer(queries, environment), {0, 0, 0}, {0, 1, 0}, 16), glm::dvec3(2, 3, 5) * 0.8,
                1e-5);
    expect_near(irradiance(PathTracer(queries, environment), {0, 0, 0}, {0, -1, 0}, 16), glm::dvec3(0), 0);
}

TEST(PathTracer, IrradianceOfADiscLight) {
    // A uniform disc wholly above the horizon gives pi L sin^2(half angle) x cosine of its middle.
    const PatchScene scene;
    const RayQueries queries(scene);
    for (const float half_angle : {0.00465f, 0.1f, 0.6f}) {
        Environment environment = black;
        add_sun(environment, {0.6f, 0.8f, 0}, glm::vec3(2), half_angle);
        expect_near(irradiance(PathTracer(queries, environment), {0, 0, 0}, {0, 1, 0}), glm::dvec3(1.6), 0.001);
    }
}

TEST(PathTracer, HalfRisenDiscGivesItsAnalyticIrradiance) {
    // A disc with its middle on the horizon: E = L x (a - sin a cos a) for half angle a (integral of sin^2 t over the
    // half disc).
    const PatchScene scene;
    const RayQueries queries(scene);
    Environment environment = black;
    const double half = 0.5, radiance = 3;
    add_sun(environment, {1, 0, 0}, glm::vec3(float(radiance * kPiDouble * std::pow(std::sin(half), 2))), float(half));
    // In polar coordinates around +X: direction (cos t, sin t cos p, sin t sin p), height sin t cos p, p in (-pi/2,
    // pi/2): L * int_0^a sin t * sin t dt * int cos p dp = L * (a - sin a cos a) / 2 * 2.
    const double expected = radiance * (half - std::sin(half) * std::cos(half));
    expect_near(irradiance(PathTracer(queries, environment), {0, 0, 0}, {0, 1, 0}), glm::dvec3(expected), 0.003);
}

TEST(PathTracer, IrradianceOfAPointLight) {
    const PatchScene scene;
    const RayQueries queries(scene);
    Environment environment = black;
    environment.point_lights.push_back({"lamp", {1, 2, 2}, {9, 18, 27}});
    expect_near(irradiance(PathTracer(queries, environment), {0, 0, 0}, {0, 1, 0}, 16), glm::dvec3(1, 2, 3) * (2.0 / 3),
                1e-5);
}

TEST(PathTracer, LeafReflectsAndTransmits) {
    PatchScene scene;
    scene.optics = {{{0.1f, 0.2f, 0.3f}, {0.4f, 0.3f, 0.2f}}};
    test::add_rectangle(scene, {-1, 0, -1}, {0, 0, 2}, {2, 0, 0}); // front is +Y
    const RayQueries queries(scene);
    Environment environment = black;
    add_sun(environment, {0.6f, 0.8f, 0}, glm::vec3(10));
    const PathTracer tracer(queries, environment);
    Random random(1);
    const glm::vec3 above = tracer.sample_radiance({0.2f, 3, 0.1f}, {0, -1, 0}, random);
    const glm::vec3 below = tracer.sample_radiance({0.2f, -3, 0.1f}, {0, 1, 0}, random);
    expect_near(glm::dvec3(above), glm::dvec3(0.1, 0.2, 0.3) * 8.0 / kPiDouble, 1e-4);
    expect_near(glm::dvec3(below), glm::dvec3(0.4, 0.3, 0.2) * 8.0 / kPiDouble, 1e-4);
    // The receiver under the leaf is in shadow but sees the leaf glow: form factor of the rectangle from 1 below its
    // middle.
    const double X = 1, corner = 2 * X / std::sqrt(2.0) * std::atan(1 / std::sqrt(2.0)) / (2 * kPiDouble);
    expect_near(irradiance(tracer, {0, -1, 0}, {0, 1, 0}), glm::dvec3(0.4, 0.3, 0.2) * 8.0 * 4.0 * corner, 0.002);
}

TEST(PathTracer, LightPassesTheOpenHalfOfAMaskedLeaf) {
    PatchScene scene;
    scene.optics.resize(1); // black
    test::add_rectangle(scene, {-1, 1, -1}, {0, 0, 2}, {2, 0, 0});
    test::mask_rectangles(scene, test::checkered_mask(8));
    const RayQueries queries(scene);
    Environment environment = black;
    add_sun(environment, {0, 1, 0}, glm::vec3(2));
    const PathTracer tracer(queries, environment);
    double mean = 0;
    for (int i = 0; i < kPaths; ++i) {
        PathNumbers numbers(5, std::uint32_t(i));
        const glm::vec2 place = 2.f * numbers.pair() - 1.f;
        mean += double(tracer.sample_irradiance({place.x, 0, place.y}, {0, 1, 0}, numbers).total.g) / kPaths;
    }
    EXPECT_NEAR(mean, 1, 0.001);
}

TEST(PathTracer, GroundReflectsWhatItReceives) {
    PatchScene scene;
    scene.ground = Ground{-0.5f, {0.2f, 0.4f, 0.6f}};
    const RayQueries queries(scene);
    Environment environment = constant_environment(glm::vec3(1));
    add_sun(environment, {3, 4, 0}, glm::vec3(10));
    const PathTracer tracer(queries, environment);
    // The ground's radiosity is albedo x (pi + 8). Downwards a point sees nothing else; sideways it is one half of what
    // it sees.
    const glm::dvec3 radiosity = glm::dvec3(0.2, 0.4, 0.6) * (kPiDouble + 8);
    expect_near(irradiance(tracer, {0, 1, 0}, {0, -1, 0}), radiosity, 0.002);
    expect_near(irradiance(tracer, {0, 1, 0}, {0, 0, 1}), 0.5 * radiosity + 0.5 * kPiDouble, 0.002);
    expect_near(irradiance(tracer, {0, 1, 0}, {0, 1, 0}), glm::dvec3(kPiDouble + 8), 1e-4);
}

TEST(PathTracer, NothingArrivesBelowTheGround) {
    PatchScene scene;
    scene.ground = Ground{};
    const RayQueries queries(scene);
    Environment environment = constant_environment(glm::vec3(1));
    add_sun(environment, {0, -1, 0.1f}, glm::vec3(10));
    const PathTracer tracer(queries, environment);
    Random random(1);
    for (const float y : {-1.f, 1.f}) {
        expect_near(irradiance(tracer, {0, -0.5f, 0}, {0, y, 0}, 256), glm::dvec3(0), 0);
        EXPECT_EQ(tracer.sample_radiance({0, -0.5f, 0}, {0, y, 0}, random), glm::vec3(0));
    }
    // The sun below the ground lights nothing above it.
    expect_near(irradiance(tracer, {0, 1, 0}, {0, 1, 0}), glm::dvec3(kPiDouble), 1e-4);
}

TEST(PathTracer, RoundingPutsNoFloorBelowTheGround) {
    PatchScene scene;
    scene.optics.resize(1);
    test::add_rectangle(scene, {-9, 1.7f, -9}, {0, 0, 18}, {18, 0, 0});
    scene.ground = Ground{1.7f, glm::vec3(0.2f)};
    const RayQueries queries(scene);
    const Environment environment = constant_environment(glm::vec3(1));
    const PathTracer tracer(queries, environment);
    expect_near(irradiance(tracer, {0, std::nextafter(1.7f, 0.f), 0}, {0, 1, 0}), glm::dvec3(kPiDouble), 1e-4);
}

Environment spotted_environment() {
    Environment environment;
    environment.remainder = Image(32, 16, 3);
    Random random(8);
    for (float& value : environment.remainder.pixels)
        value = 0.1f;
    for (int spot = 0; spot < 3; ++spot) {
        float* pixel = environment.remainder.at(int(random.below(32)), int(random.below(10)));
        pixel[0] = 60, pixel[1] = 40, pixel[2] = 20;
    }
    return environment;
}

TEST(PathTracer, ImportanceSamplingChangesNoiseButNotTheMean) {
    const Environment environment = spotted_environment();
    PatchScene scene = test::random_crown(400, 2, {glm::vec3(0.3f), glm::vec3(0.4f)});
    scene.ground = Ground{};
    const RayQueries queries(scene);
    glm::dvec3 mean[2] = {glm::dvec3(0), glm::dvec3(0)};
    double square[2] = {0, 0};
    const int paths = 1 << 17;
    for (const bool on : {false, true}) {
        PathTracerOptions options;
        options.sample_remainder = on;
        const PathTracer tracer(queries, environment, options);
        Random random(3);
        for (int i = 0; i < paths; ++i) {
            const glm::vec3 value = tracer.sample_irradiance({0.1f, 2.9f, 0.2f}, {0, 1, 0}, random).total;
            mean[on] += glm::dvec3(value) / double(paths);
            square[on] += double(value.g) * double(value.g) / paths;
        }
    }
    const double variance[2] = {square[0] - mean[0].g * mean[0].g, square[1] - mean[1].g * mean[1].g};
    EXPECT_LT(variance[1], 0.5 * variance[0]);
    EXPECT_NEAR(mean[0].g, mean[1].g, 4 * std::sqrt((variance[0] + variance[1]) / paths));
    EXPECT_NEAR(mean[0].r / mean[1].r, 1, 0.05);
}

TEST(PathTracer, RouletteChangesNoiseButNotTheMean) {
    const Environment environment = constant_environment(glm::vec3(1, 2, 3));
    const PatchScene scene = test::random_crown(400, 4, {{0.3f, 0.5f, 0.1f}, {0.4f, 0.4f, 0.2f}});
    const RayQueries queries(scene);
    PathTracerOptions late;
    late.roulette_after = 30;
    const glm::dvec3 with = irradiance(PathTracer(queries, environment), {0, 2, 0}, {0, 1, 0}, 1 << 17);
    const glm::dvec3 without = irradiance(PathTracer(queries, environment, late), {0, 2, 0}, {0, 1, 0}, 1 << 17);
    expect_near(with, without, 0.01);
}

TEST(PathTracer, TellsWhatThePathMet) {
    PatchScene scene;
    scene.optics = {{glm::vec3(0.5f), glm::vec3(0)}};
    scene.ground = Ground{-1, glm::vec3(0.2f)};
    test::add_rectangle(scene, {-1e4f, 1, 0}, {2e4f, 0, 0}, {0, 0, 1e4f}); // covers the half of the sky with z > 0
    const RayQueries queries(scene);
    Environment environment = constant_environment(glm::vec3(1));
    add_sun(environment, {0, 1, -1}, glm::vec3(3));
    const PathTracer tracer(queries, environment);
    double sky = 0, ground = 0, patch = 0;
    for (int i = 0; i < kPaths; ++i) {
        PathNumbers up(1, std::uint32_t(i)), sideways(2, std::uint32_t(i));
        const auto above = tracer.sample_irradiance({0, 0, 0}, {0, 1, 0}, up);
        const auto beside = tracer.sample_irradiance({0, 0, 0}, {1, 0, 0}, sideways);
        sky += above.first_met == PathTracer::Met::sky ? double(above.path_weight) / kPaths : 0;
        patch += above.first_met == PathTracer::Met::patch ? double(above.path_weight) / kPaths : 0;
        ground += beside.first_met == PathTracer::Met::ground ? double(beside.path_weight) / kPaths : 0;
        EXPECT_LE(above.from_patches.g + above.direct_from_lights.g, above.total.g * 1.0001f);
        EXPECT_NEAR(above.direct_from_lights.g, 3 * std::sqrt(0.5f), 1e-4);
    }
    EXPECT_NEAR(sky, 0.5, 0.002);
    EXPECT_NEAR(patch, 0.5, 0.002);
    EXPECT_NEAR(ground, 0.5, 0.002);
    EXPECT_GT(tracer.rays_traced(), std::uint64_t(kPaths));
}

TEST(PathTracer, CameraSeesDiscsButNoPoints) {
    const PatchScene scene;
    const RayQueries queries(scene);
    Environment environment = constant_environment(glm::vec3(1));
    add_sun(environment, {0, 1, 0}, glm::vec3(2), 0.1f);
    add_sun(environment, {1, 0, 0}, glm::vec3(2));
    const PathTracer tracer(queries, environment);
    Random random(1);
    const float disc = 2 / (kPi * std::pow(std::sin(0.1f), 2.f));
    EXPECT_NEAR(tracer.sample_radiance({0, 0, 0}, {0, 1, 0}, random).g, 1 + disc, 1e-4 * disc);
    EXPECT_EQ(tracer.sample_radiance({0, 0, 0}, {0, -1, 0}, random).g, 1);
    EXPECT_EQ(tracer.sample_radiance({0, 0, 0}, {1, 0, 0}, random).g, 1);
}

TEST(PathTracer, OtherOpticsReplaceTheScenes) {
    PatchScene scene;
    scene.optics = {{glm::vec3(0.5f), glm::vec3(0)}};
    test::add_rectangle(scene, {-1, 0, -1}, {0, 0, 2}, {2, 0, 0});
    const RayQueries queries(scene);
    Environment environment = black;
    add_sun(environment, {0, 1, 0}, glm::vec3(1));
    PathTracerOptions options;
    options.optics = {{glm::vec3(0.25f), glm::vec3(0)}};
    Random random(1);
    EXPECT_NEAR(PathTracer(queries, environment, options).sample_radiance({0, 1, 0.1f}, {0, -1, 0}, random).g,
                0.25f / kPi, 1e-5);
    options.optics.resize(2);
    EXPECT_THROW(PathTracer(queries, environment, options), InputError);
}

} // namespace
} // namespace kokage
