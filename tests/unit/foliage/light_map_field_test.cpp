#include "common/directions/spherical_harmonics.h"
#include "common/services/error.h"
#include "common/services/parallel.h"
#include "foliage/light_map_field.h"
#include "tests/unit/foliage/rooms.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

LightMapFieldOptions options_of(GatherRule gather, int maps = 40) {
    LightMapFieldOptions options;
    options.gather = gather;
    options.maps = maps;
    return options;
}

SideRadiance random_radiance(std::size_t patches, std::uint64_t seed) {
    SideRadiance radiance;
    Random random(seed);
    for (std::size_t p = 0; p < patches; ++p) {
        radiance.front.emplace_back(random.uniform(), random.uniform(), random.uniform());
        radiance.back.emplace_back(random.uniform(), random.uniform(), random.uniform());
    }
    return radiance;
}

class EitherGather : public testing::TestWithParam<GatherRule> {};
INSTANTIATE_TEST_SUITE_P(LightMapField, EitherGather, testing::Values(GatherRule::rule, GatherRule::cosine));

TEST_P(EitherGather, SharesAreConvex) {
    const test::SmallTree small = test::ball_on_a_skeleton(800, 3, test::bright_leaf());
    const RayQueries queries(small.scene);
    const LightMapField field(queries, {}, small.tree, options_of(GetParam()), silent_progress());
    for (std::size_t p = 0; p < small.scene.patches.size(); ++p) {
        double sum = 0;
        for (const LightMapField::Reading& reading : field.readings(p)) {
            EXPECT_GE(reading.share, 0);
            EXPECT_LT(reading.map, field.maps().places().size());
            sum += reading.share;
        }
        EXPECT_NEAR(sum, 1, 1e-6);
    }
}

TEST_P(EitherGather, InAClosedRoomOfOneRadianceEverySideGetsPiTimesIt) {
    const test::SmallTree room = test::crown_in_a_room(400, test::bright_leaf());
    const RayQueries queries(room.scene);
    LightMapField field(queries, {}, room.tree, options_of(GetParam()), silent_progress());
    const std::vector<glm::vec3> one(room.scene.patches.size(), glm::vec3(1, 0.5f, 2));
    field.update({one, one}, {});
    const SideIrradiance irradiance = field.irradiance();
    for (std::size_t p = 0; p < one.size(); ++p) {
        EXPECT_LT(glm::distance(irradiance.front[p], kPi * one[p]), 3e-5f);
        EXPECT_LT(glm::distance(irradiance.back[p], kPi * one[p]), 3e-5f);
    }
}

// The bound that makes the iteration contract: nothing below 0, nothing above pi x the brightest.
TEST_P(EitherGather, NeverExceedsTheBrightestSideNorFallsBelowZero) {
    const test::SmallTree room = test::crown_in_a_room(400, test::bright_leaf());
    const RayQueries queries(room.scene);
    for (int bands : {1, 2, 3, 7, 10}) {
        LightMapFieldOptions options = options_of(GetParam());
        options.bands = bands;
        options.least_directions = 1; // the fewest that the rule of quadrature allows
        LightMapField field(queries, {}, room.tree, options, silent_progress());
        for (std::uint64_t seed = 0; seed < 4; ++seed) {
            SideRadiance radiance = random_radiance(room.scene.patches.size(), seed);
            for (std::vector<glm::vec3>* side : {&radiance.front, &radiance.back})
                for (glm::vec3& value : *side) // extremes: each side black or 1
                    value = glm::step(glm::vec3(0.9f), value);
            field.update(radiance, {});
            const SideIrradiance irradiance = field.irradiance();
            for (const std::vector<glm::vec3>* side : {&irradiance.front, &irradiance.back})
                for (const glm::vec3& value : *side)
                    for (std::size_t c = 0; c < 3; ++c) {
                        EXPECT_GE(value[c], 0);
                        EXPECT_LE(value[c], kPi);
                    }
        }
    }
}

// Energy in a closed room: whatever differs between two states shrinks by the albedo at least, bounce by bounce; at
// albedo 1 it does not grow.
TEST_P(EitherGather, AClosedRoomContractsByItsAlbedo) {
    const test::SmallTree room = test::crown_in_a_room(400, test::bright_leaf());
    const RayQueries queries(room.scene);
    LightMapField field(queries, {}, room.tree, options_of(GetParam()), silent_progress());
    for (float albedo : {0.5f, 0.9f, 0.99f, 1.f}) {
        const Optics optics = test::grey_leaf(albedo);
        SideRadiance radiance = random_radiance(room.scene.patches.size(), 5);
        float largest = 1;
        for (int bounce = 0; bounce < 25; ++bounce) {
            field.update(radiance, {});
            const SideIrradiance e = field.irradiance();
            float next = 0;
            for (std::size_t p = 0; p < radiance.front.size(); ++p) {
                radiance.front[p] = (optics.reflectance * e.front[p] + optics.transmittance * e.back[p]) / kPi;
                radiance.back[p] = (optics.reflectance * e.back[p] + optics.transmittance * e.front[p]) / kPi;
                for (const glm::vec3& value : {radiance.front[p], radiance.back[p]})
                    next = std::max({next, value.r, value.g, value.b});
            }
            EXPECT_LE(next, albedo * largest) << albedo << ' ' << bounce;
            largest = next;
        }
        EXPECT_GT(largest, 0.1f * std::pow(albedo, 25.f)) << "and light is not lost either";
    }
}

// Without its clamp against rounding, the field is linear: the difference of two readings is the reading of the
// difference.
TEST_P(EitherGather, IsLinear) {
    const test::SmallTree small = test::ball_on_a_skeleton(500, 2, test::bright_leaf());
    const RayQueries queries(small.scene);
    LightMapField field(queries, {}, small.tree, options_of(GetParam()), silent_progress());
    const std::size_t patches = small.scene.patches.size();
    const SideRadiance a = random_radiance(patches, 1), b = random_radiance(patches, 2);
    SideRadiance sum = a;
    for (std::size_t p = 0; p < patches; ++p) {
        sum.front[p] += 2.f * b.front[p];
        sum.back[p] += 2.f * b.back[p];
    }
    const auto read = [&](const SideRadiance& radiance) {
        field.update(radiance, {});
        return field.irradiance();
    };
    const SideIrradiance of_a = read(a), of_b = read(b), of_sum = read(sum);
    for (std::size_t p = 0; p < patches; ++p)
        EXPECT_LT(glm::distance(of_sum.back[p], of_a.back[p] + 2.f * of_b.back[p]), 1e-4f);
}

TEST_P(EitherGather, DoesNotDependOnThreads) {
    const test::SmallTree small = test::ball_on_a_skeleton(800, 2, test::bright_leaf());
    const RayQueries queries(small.scene);
    const SideRadiance radiance = random_radiance(small.scene.patches.size(), 1);
    const auto read = [&](int threads) {
        set_thread_count(threads);
        LightMapField field(queries, {}, small.tree, options_of(GetParam()), silent_progress());
        field.update(radiance, {});
        return field.irradiance();
    };
    const SideIrradiance one = read(1), two = read(2);
    set_thread_count(0);
    EXPECT_EQ(one.front, two.front);
    EXPECT_EQ(one.back, two.back);
}

TEST_P(EitherGather, FilledSharesScaleByTheGeometricMean) {
    const test::SmallTree small = test::ball_on_a_skeleton(500, 2, test::bright_leaf());
    const RayQueries queries(small.scene);
    const std::size_t patches = small.scene.patches.size();
    LightMapField plain(queries, {}, small.tree, options_of(GetParam()), silent_progress());
    LightMapField told(queries, {}, small.tree, options_of(GetParam()), silent_progress());
    std::vector<float> front(patches), back(patches);
    Random random(9);
    for (std::size_t p = 0; p < patches; ++p) {
        front[p] = random.uniform();
        back[p] = p % 7 == 0 ? 0 : 1;
    }
    told.set_filled_shares(front, back);
    const std::vector<glm::vec3> one(patches, glm::vec3(1));
    plain.update({one, one}, {});
    told.update({one, one}, {});
    const SideIrradiance seen = plain.irradiance(), scaled = told.irradiance();
    for (std::size_t p = 0; p < patches; ++p) {
        EXPECT_NEAR(scaled.front[p].g, std::sqrt(seen.front[p].g * kPi * front[p]), 1e-4f);
        EXPECT_NEAR(scaled.back[p].g, std::sqrt(seen.back[p].g * kPi * back[p]), 1e-4f);
        EXPECT_LE(scaled.front[p].g, kPi);
        EXPECT_LE(scaled.back[p].g, kPi);
    }
}

TEST_P(EitherGather, FilledSharesOfOneKeepAClosedRoomExact) {
    const test::SmallTree room = test::crown_in_a_room(400, test::bright_leaf());
    const RayQueries queries(room.scene);
    LightMapField field(queries, {}, room.tree, options_of(GetParam()), silent_progress());
    const std::size_t patches = room.scene.patches.size();
    field.set_filled_shares(std::vector<float>(patches, 1.f), std::vector<float>(patches, 1.f));
    const std::vector<glm::vec3> one(patches, glm::vec3(1));
    field.update({one, one}, {});
    for (const glm::vec3& value : field.irradiance().front) {
        EXPECT_NEAR(value.g, kPi, 3e-5f);
        EXPECT_LE(value.g, kPi);
    }
}

/// One map at the origin under a bright ceiling; a leaf anywhere reads it alone.
TEST(LightMapField, CosineReadsIrradianceThatFallsOnEitherSide) {
    test::SmallTree small;
    small.scene.optics.resize(1);
    test::add_rectangle(small.scene, {0, 0.01f, 0}, {0, 0, 0.001f}, {0.001f, 0, 0}); // a tiny leaf, front upwards
    test::add_rectangle(small.scene, {-500, 1, -500}, {1000, 0, 0}, {0, 0, 1000});   // the ceiling, front downwards
    small.tree.leaves = {{{0, 0, 0}, -1}};
    const RayQueries queries(small.scene);
    LightMapField field(queries, {}, small.tree, options_of(GatherRule::cosine), silent_progress());
    SideRadiance radiance{std::vector<glm::vec3>(2, glm::vec3(0)), std::vector<glm::vec3>(2, glm::vec3(0))};
    radiance.front[1] = glm::vec3(1);
    field.update(radiance, {});
    const SideIrradiance irradiance = field.irradiance();
    // A half sphere of 1 above: pi on the front, 0 on the back, but for the kernel's width.
    EXPECT_GT(irradiance.front[0].r, 0.85f * kPi);
    EXPECT_LT(irradiance.back[0].r, 0.15f * kPi);
    EXPECT_NEAR(irradiance.front[0].r + irradiance.back[0].r, kPi, 0.02f);
}

// Twin: the map convolved with kernel and cosine, integrated over directions by brute force.
TEST(LightMapField, CosineAgreesWithAnIntegralOverTheMap) {
    const test::SmallTree small = test::ball_on_a_skeleton(300, 2, test::bright_leaf());
    const RayQueries queries(small.scene);
    LightMapField field(queries, {}, small.tree, options_of(GatherRule::cosine, 5), silent_progress());
    field.update(random_radiance(small.scene.patches.size(), 3), {});
    const SideIrradiance irradiance = field.irradiance();
    const std::vector<LightMap> maps = field.export_maps({}); // windowed
    const CaptureDirections sphere = make_capture_directions(1, 20000);
    const PatchGeometry geometry = patch_geometry(small.scene);
    for (std::size_t p = 0; p < 20; ++p) {
        glm::dvec3 front{0.0}, back{0.0};
        for (const LightMapField::Reading& reading : field.readings(p))
            for (std::size_t k = 0; k < sphere.size(); ++k) {
                const double cosine = glm::dot(sphere.directions[k], geometry.normals[p]);
                (cosine > 0 ? front : back) +=
                    glm::dvec3(sh_radiance(maps[reading.map].coefficients, sphere.directions[k])) *
                    double(reading.share) * std::abs(cosine) * double(sphere.solid_angles[k]);
            }
        EXPECT_LT(glm::distance(glm::vec3(front), irradiance.front[p]), 5e-3f) << p;
        EXPECT_LT(glm::distance(glm::vec3(back), irradiance.back[p]), 5e-3f) << p;
    }
}

TEST(LightMapField, ATubeOfBarkGetsTheMeanOverItsWholeSurface) {
    test::SmallTree small;
    small.scene.optics.resize(1);
    const float r = 0.1f; // a square tube around the y axis, one patch of eight triangles, fronts outwards
    std::vector<glm::vec3> corners;
    const glm::vec3 ring[4] = {{r, 0, r}, {r, 0, -r}, {-r, 0, -r}, {-r, 0, r}};
    for (int i = 0; i < 4; ++i) {
        const glm::vec3 a = ring[i], b = ring[(i + 1) % 4], up(0, 0.2f, 0);
        for (const glm::vec3& corner : {a, b, b + up, a, b + up, a + up})
            corners.push_back(corner);
    }
    test::add_leaf(small.scene, corners);
    small.scene.patches[0].kind = PatchKind::bark;
    test::add_rectangle(small.scene, {5, -500, -500}, {0, 0, 1000}, {0, 1000, 0}); // a wall at +X, front towards -X
    test::add_branch(small.tree.skeleton, -1, {0, -1, 0}, {0, 1, 0}, r);
    test::add_branch(small.tree.skeleton, 0, {0, 0.1f, 0}, {0.1f, 0.1f, 0}, r);
    const RayQueries queries(small.scene);
    LightMapField field(queries, {}, small.tree, options_of(GatherRule::cosine), silent_progress());
    const std::vector<glm::vec3> one = {glm::vec3(0), glm::vec3(1)};
    field.update({one, one}, {});
    // A half sphere of radiance 1 sideways: pi on the side that faces it, pi/2 on the two beside it, 0 behind.
    EXPECT_NEAR(field.irradiance().front[0].r, kPi / 2, 0.03f * kPi);
    EXPECT_EQ(field.irradiance().back[0], glm::vec3(0));
}

TEST(LightMapField, MapsBehindALeafCountLittle) {
    // Two maps, equally far left and right of a reader; a wall stands between it and the left one.
    test::SmallTree small;
    small.scene.optics.resize(1);
    test::add_rectangle(small.scene, {0, 1, 0}, {0.001f, 0, 0}, {0, 0, 0.001f});
    test::add_rectangle(small.scene, {-0.5f, -9, -10}, {0, 20, 0}, {0, 0, 20});
    test::add_branch(small.tree.skeleton, -1, {0, 0, 0}, {0, 1, 0}, 0);
    test::add_branch(small.tree.skeleton, 0, {-1, 1, 0}, {-1, 2, 0}, 0);
    test::add_branch(small.tree.skeleton, 0, {1, 1, 0}, {1, 2, 0}, 0);
    const RayQueries queries(small.scene);
    const LightMapField field(queries, {}, small.tree, options_of(GatherRule::cosine), silent_progress());
    for (const LightMapField::Reading& reading : field.readings(0)) {
        const bool left = field.maps().places()[reading.map].position.x < 0;
        EXPECT_NEAR(reading.share, left ? 0.05f / 1.05f : 1 / 1.05f, 0.02f);
    }
}

TEST(LightMapField, MapsThatNobodyReadsAreNotCaptured) {
    test::SmallTree small;
    small.scene.optics.resize(1);
    test::add_rectangle(small.scene, {0, 1, 0}, {0.001f, 0, 0}, {0, 0, 0.001f});
    test::add_branch(small.tree.skeleton, -1, {0, 0, 0}, {0, 1, 0});
    for (int i = 0; i < 20; ++i)
        test::add_branch(small.tree.skeleton, 0, {float(i), 1, 0}, {float(i), 2, 0});
    const RayQueries queries(small.scene);
    const LightMapField field(queries, {}, small.tree, options_of(GatherRule::cosine, 20), silent_progress());
    EXPECT_EQ(field.placement().places.size(), 20u);
    EXPECT_EQ(field.maps().places().size(), 4u);
    EXPECT_EQ(field.unread_maps(), 16u);
    for (const LightMapPlace& place : field.maps().places())
        EXPECT_LT(place.position.x, 3.5f);
}

TEST(LightMapField, EmptySceneAndLeafAtAMapAreFine) {
    const PatchScene empty;
    const RayQueries none(empty);
    LightMapField nothing(none, {}, Tree{}, {}, silent_progress());
    nothing.update({}, {});
    EXPECT_TRUE(nothing.irradiance().front.empty());

    test::SmallTree one;
    one.scene.optics.resize(1);
    test::add_rectangle(one.scene, {0, 0, 0}, {2, 0, 0}, {0, 0, 2});
    one.tree.leaves = {{{1, 0, 1}, -1}}; // the one map stands exactly at the leaf's centre
    const RayQueries queries(one.scene);
    for (GatherRule gather : {GatherRule::rule, GatherRule::cosine}) {
        LightMapField field(queries, {}, one.tree, options_of(gather), silent_progress());
        field.update({{glm::vec3(1)}, {glm::vec3(1)}}, {});
        EXPECT_TRUE(std::isfinite(field.irradiance().front[0].r));
    }
}

TEST(LightMapField, RefusesBandsOutOfRange) {
    const PatchScene empty;
    const RayQueries queries(empty);
    for (int bands : {0, 41}) {
        LightMapFieldOptions options;
        options.bands = bands;
        EXPECT_THROW(LightMapField(queries, {}, Tree{}, options, silent_progress()), InputError);
    }
}

} // namespace
} // namespace kokage
