// Embree against a loop over all triangles in double precision, and the corners: holes, ground, scale, nothing at all.
#include "common/trace/ray_queries.h"
#include "tests/unit/common/scene_builders.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

struct SlowHit {
    double distance = INFINITY;
    std::size_t triangle = 0;
};

/// Moeller and Trumbore 1997, over all triangles.
SlowHit slow_first_hit(const PatchScene& scene, const glm::dvec3& origin, const glm::dvec3& direction) {
    SlowHit best;
    for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
        const glm::dvec3 a(scene.positions[scene.triangles[t].x]),
            ab = glm::dvec3(scene.positions[scene.triangles[t].y]) - a,
            ac = glm::dvec3(scene.positions[scene.triangles[t].z]) - a;
        const glm::dvec3 p = glm::cross(direction, ac), s = origin - a, q = glm::cross(s, ab);
        const double determinant = glm::dot(ab, p);
        if (determinant == 0)
            continue;
        const double u = glm::dot(s, p) / determinant, v = glm::dot(direction, q) / determinant,
                     distance = glm::dot(ac, q) / determinant;
        if (u < 0 || v < 0 || u + v > 1 || distance <= 0 || distance >= best.distance)
            continue;
        if (scene.masked(t)) {
            const glm::uvec3& c = scene.triangles[t];
            const glm::vec2 uv =
                float(1 - u - v) * scene.uvs[c.x] + float(u) * scene.uvs[c.y] + float(v) * scene.uvs[c.z];
            if (!scene.masks[std::size_t(scene.triangle_mask[t])].solid(uv))
                continue;
        }
        best = {distance, t};
    }
    return best;
}

void compare_with_slow_twin(const PatchScene& scene, float size) {
    const RayQueries queries(scene);
    Random random(7);
    int hits = 0, disagreements = 0;
    const int rays = 3000;
    for (int i = 0; i < rays; ++i) {
        const glm::vec3 origin = size * (glm::vec3(0, 2, 0) + 1.5f * test::random_direction(random));
        const glm::vec3 aim = size * (glm::vec3(0, 2, 0) + random.uniform() * test::random_direction(random));
        const glm::vec3 direction = glm::normalize(aim - origin);
        const SlowHit truth = slow_first_hit(scene, origin, direction);
        RayHit hit;
        const bool found = queries.first_hit(origin, direction, 0, INFINITY, hit);
        EXPECT_EQ(found, queries.occluded(origin, direction, 0, INFINITY));
        if (found != (truth.distance < INFINITY) || (found && hit.triangle != truth.triangle)) {
            ++disagreements; // within rounding of an edge or of a texel's border
            continue;
        }
        hits += found;
        if (!found)
            continue;
        // Rounding across the plane becomes longer along a grazing ray.
        const float cosine = std::abs(glm::dot(hit.geometric_normal, direction)),
                    tolerance = 1e-6f * size * (1 + 1 / cosine);
        EXPECT_NEAR(hit.distance, truth.distance, tolerance);
        const glm::uvec3& c = scene.triangles[hit.triangle];
        const glm::vec3 a = scene.positions[c.x], b = scene.positions[c.y], d = scene.positions[c.z];
        const glm::vec3 place = a + hit.barycentric.x * (b - a) + hit.barycentric.y * (d - a);
        EXPECT_LT(glm::length(place - (origin + hit.distance * direction)), 2 * tolerance);
        // Agreement in sign with the counter-clockwise side.
        EXPECT_GT(glm::dot(hit.geometric_normal, glm::normalize(glm::cross(b - a, d - a))), 0.9999f);
        // Nothing in front of it, something up to behind it.
        EXPECT_FALSE(queries.occluded(origin, direction, 0, hit.distance * 0.9999f));
        EXPECT_TRUE(queries.occluded(origin, direction, 0, hit.distance * 1.0001f));
    }
    EXPECT_GT(hits, rays / 4);
    EXPECT_LE(disagreements, 3);
}

PatchScene scaled(PatchScene scene, float scale) {
    for (glm::vec3& position : scene.positions)
        position *= scale;
    return scene;
}

TEST(RayQueries, AgreesWithALoopOverAllTriangles) {
    compare_with_slow_twin(test::random_crown(300, 3, {}), 1);
}

TEST(RayQueries, AgreesOnAlphaMaskedTriangles) {
    PatchScene scene = test::random_crown(300, 3, {});
    test::mask_rectangles(scene, test::checkered_mask(5));
    compare_with_slow_twin(scene, 1);
}

TEST(RayQueries, TinyAndHugeScenesGiveTheSameHits) {
    const PatchScene scene = test::random_crown(300, 3, {});
    compare_with_slow_twin(scaled(scene, 1e-6f / 3), 1e-6f / 3);
    compare_with_slow_twin(scaled(scene, 1e6f / 3), 1e6f / 3);
}

TEST(RayQueries, RayLeavingASurfaceDoesNotMeetItAgain) {
    for (const float scale : {1e-6f, 1.f, 1e6f}) {
        const PatchScene scene = scaled(test::random_crown(1000, 0.01f, {}), scale);
        const RayQueries queries(scene);
        Random random(3);
        for (int i = 0; i < 4000; ++i) {
            const std::uint32_t t = random.below(std::uint32_t(scene.triangles.size()));
            const glm::uvec3& c = scene.triangles[t];
            const float u = random.uniform() * 0.5f, v = random.uniform() * 0.5f;
            const glm::vec3 a = scene.positions[c.x], ab = scene.positions[c.y] - a, ac = scene.positions[c.z] - a;
            const glm::vec3 normal = glm::normalize(glm::cross(ab, ac));
            // As grazing as float allows.
            const glm::vec3 direction = glm::normalize(glm::normalize(ab + ac) + 1e-4f * random.uniform() * normal);
            RayHit hit;
            if (queries.first_hit(a + u * ab + v * ac + queries.ray_offset() * normal, direction, 0, INFINITY, hit)) {
                EXPECT_NE(hit.triangle / 2, t / 2) << "scale " << scale;
            }
        }
    }
}

TEST(RayQueries, GroundIsMetExactlyAndFromBelow) {
    PatchScene scene;
    scene.ground = Ground{-2.f, glm::vec3(0.2f)};
    const RayQueries queries(scene);
    RayHit hit;
    ASSERT_TRUE(queries.first_hit({5, 1, -3}, {0, -1, 0}, 0, INFINITY, hit));
    EXPECT_TRUE(hit.ground);
    EXPECT_EQ(hit.distance, 3.f);
    EXPECT_EQ(hit.geometric_normal, glm::vec3(0, 1, 0));
    EXPECT_FALSE(queries.first_hit({5, 1, -3}, {0, -1, 0}, 0, 3.f, hit)) << "far is open";
    EXPECT_FALSE(queries.first_hit({5, 1, -3}, {1, 0, 0}, 0, INFINITY, hit));
    EXPECT_FALSE(queries.first_hit({5, 1, -3}, {0, 1, 0}, 0, INFINITY, hit));
    ASSERT_TRUE(queries.first_hit({0, -4, 0}, {0, 1, 0}, 0, INFINITY, hit));
    EXPECT_EQ(hit.distance, 2.f);
    EXPECT_TRUE(queries.occluded({5, 1, -3}, {0, -1, 0}, 0, INFINITY));
    EXPECT_FALSE(queries.occluded({5, 1, -3}, {0, -1, 0}, 0, 2.9f));
}

TEST(RayQueries, NearerOfPatchAndGroundWins) {
    PatchScene scene;
    scene.optics.resize(1);
    test::add_rectangle(scene, {-1, 1, -1}, {0, 0, 2}, {2, 0, 0});
    scene.ground = Ground{};
    const RayQueries queries(scene);
    RayHit hit;
    ASSERT_TRUE(queries.first_hit({0.3f, 3, 0.2f}, {0, -1, 0}, 0, INFINITY, hit));
    EXPECT_FALSE(hit.ground);
    EXPECT_FLOAT_EQ(hit.distance, 2.f);
    ASSERT_TRUE(queries.first_hit({1.3f, 3, 0.2f}, {0, -1, 0}, 0, INFINITY, hit));
    EXPECT_TRUE(hit.ground);
    ASSERT_TRUE(queries.first_hit({0.3f, 0.5f, 0.2f}, {0, -1, 0}, 0, INFINITY, hit));
    EXPECT_TRUE(hit.ground);
}

/// Rays at the middle of a floor of 20 x 20 m at `height`, from all sides, level and steep, near and far.
std::vector<Ray> rays_at_a_floor(float height) {
    std::vector<Ray> rays;
    Random random(11);
    for (int i = 0; i < 4000; ++i) {
        const float away = std::exp(random.uniform(0.f, 7.f)), turn = random.uniform(0.f, 6.28f);
        const float steepness = std::pow(random.uniform(), 3.f) + 0.003f;
        const glm::vec3 aim(random.uniform(-8.f, 8.f), height, random.uniform(-8.f, 8.f));
        const glm::vec3 towards = glm::normalize(glm::vec3(std::cos(turn), -steepness, std::sin(turn)));
        rays.push_back({aim - away * towards, towards, 0, INFINITY});
    }
    return rays;
}

PatchScene floor_and_ground(float floor, float ground) {
    PatchScene scene;
    scene.optics.resize(1);
    test::add_rectangle(scene, {-10, floor, -10}, {0, 0, 20}, {20, 0, 0});
    scene.ground = Ground{ground, glm::vec3(0.2f)};
    return scene;
}

TEST(RayQueries, SurfacesInTheGroundsPlaneHideIt) {
    for (const float height : {0.f, 1.7f, -0.3f}) {
        const PatchScene scene = floor_and_ground(height, height), sunk = floor_and_ground(height - 0.05f, height);
        const RayQueries queries(scene), sunk_queries(sunk);
        const std::vector<Ray> rays = rays_at_a_floor(height);
        std::vector<RayHit> hits(rays.size());
        std::vector<std::uint8_t> found(rays.size());
        queries.first_hits(rays, hits, found);
        int grounds = 0, below = 0, in_shadow = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            RayHit hit;
            ASSERT_TRUE(found[i] && queries.first_hit(rays[i].origin, rays[i].direction, 0, INFINITY, hit));
            grounds += hit.ground || hits[i].ground;
            const glm::vec3 point = rays[i].origin + hit.distance * rays[i].direction,
                            up(-rays[i].direction.x, -rays[i].direction.y, -rays[i].direction.z);
            in_shadow += hit.distance < 100 && queries.occluded(point, up, queries.ray_offset(), INFINITY);
            ASSERT_TRUE(sunk_queries.first_hit(rays[i].origin, rays[i].direction, 0, INFINITY, hit));
            below += !hit.ground;
        }
        EXPECT_EQ(grounds, 0) << height;
        EXPECT_EQ(in_shadow, 0) << height;
        EXPECT_EQ(below, 0) << height;
    }
}

TEST(RayQueries, EmptySceneHasNoHits) {
    const PatchScene scene;
    const RayQueries queries(scene);
    RayHit hit;
    EXPECT_FALSE(queries.first_hit({0, 0, 0}, {0, 1, 0}, 0, INFINITY, hit));
    EXPECT_FALSE(queries.occluded({0, 0, 0}, {0, 1, 0}, 0, INFINITY));
    EXPECT_GT(queries.ray_offset(), 0);
}

TEST(RayQueries, TrianglesWithoutAreaAreHarmless) {
    PatchScene scene;
    scene.optics.resize(1);
    test::add_leaf(scene, {{0, 1, 0}, {0, 1, 0}, {0, 1, 0}});
    test::add_leaf(scene, {{-1, 1, 0}, {0, 1, 0}, {1, 1, 0}});
    RayHit hit;
    {
        const RayQueries queries(scene);
        EXPECT_FALSE(queries.first_hit({0, 0, 0}, {0, 1, 0}, 0, INFINITY, hit));
    }
    test::add_rectangle(scene, {-1, 2, -1}, {0, 0, 2}, {2, 0, 0});
    const RayQueries queries(scene);
    ASSERT_TRUE(queries.first_hit({0, 0, 0}, {0, 1, 0}, 0, INFINITY, hit));
    EXPECT_FLOAT_EQ(hit.distance, 2.f);
    EXPECT_GE(hit.triangle, 2u);
}

TEST(RayQueries, HalfOfAHalfMaskedLeafIsOpen) {
    PatchScene scene;
    scene.optics.resize(1);
    test::add_rectangle(scene, {-1, 1, -1}, {2, 0, 0}, {0, 0, 2});
    test::mask_rectangles(scene, test::half_mask());
    const RayQueries queries(scene);
    Random random(5);
    for (int i = 0; i < 1000; ++i) {
        const float x = random.uniform(-1, 1), z = random.uniform(-1, 1);
        EXPECT_EQ(queries.occluded({x, 0, z}, {0, 1, 0}, 0, INFINITY), x < 0) << x << " " << z;
        RayHit hit;
        EXPECT_EQ(queries.first_hit({x, 3, z}, {0, -1, 0}, 0, INFINITY, hit), x < 0);
    }
}

/// Rays of a camera, some of them short, some from below the ground.
std::vector<Ray> camera_like_rays(std::size_t count) {
    Random random(11);
    std::vector<Ray> rays;
    for (std::size_t k = 0; k < count; ++k) {
        const glm::vec3 origin(0, k % 7 == 0 ? -1.f : 2.f, 6);
        const glm::vec3 aim = glm::vec3(0, 1.5f, 0) + 2 * random.uniform() * test::random_direction(random);
        rays.push_back({origin, glm::normalize(aim - origin), 0, k % 5 == 0 ? 6.f : INFINITY});
    }
    return rays;
}

TEST(RayQueries, ManyRaysAtOnceFindWhatEachFindsAlone) {
    PatchScene scene = test::random_crown(300, 3, {});
    test::mask_rectangles(scene, test::checkered_mask(5));
    scene.ground = Ground{-0.5f, glm::vec3(0.2f)};
    const RayQueries queries(scene);
    for (const std::size_t count : {0u, 1u, 15u, 16u, 17u, 5000u}) {
        const std::vector<Ray> rays = camera_like_rays(count);
        std::vector<RayHit> hits(count);
        std::vector<std::uint8_t> found(count, 7), hidden(count, 7);
        queries.first_hits(rays, hits, found);
        queries.occluded(rays, hidden);
        std::size_t apart = 0, seen = 0;
        for (std::size_t k = 0; k < count; ++k) {
            const auto& [origin, direction, near, far] = rays[k];
            RayHit alone;
            const bool is_found = queries.first_hit(origin, direction, near, far, alone);
            seen += is_found;
            if (is_found != bool(found[k]) || queries.occluded(origin, direction, near, far) != bool(hidden[k]) ||
                (is_found && (alone.triangle != hits[k].triangle || alone.ground != hits[k].ground))) {
                ++apart; // within rounding of an edge
                continue;
            }
            if (is_found) {
                EXPECT_NEAR(hits[k].distance, alone.distance, 1e-5f);
            }
        }
        EXPECT_LE(apart, count / 1000);
        EXPECT_GE(seen, count / 3);
    }
}

TEST(RayQueries, FindTheSameByAnyMachinesInstructions) {
    // Embree splits packets that are wider than the machine's registers.
    const PatchScene scene = test::random_crown(300, 3, {});
    const RayQueries usual(scene);
    for (const std::size_t count : {3u, 21u, 4000u}) {
        const std::vector<Ray> rays = camera_like_rays(count);
        std::vector<RayHit> hits(count), usual_hits(count);
        std::vector<std::uint8_t> found(count), hidden(count), usual_found(count), usual_hidden(count);
        usual.first_hits(rays, usual_hits, usual_found);
        usual.occluded(rays, usual_hidden);
        for (const char* instructions : {"max_isa=sse2", "max_isa=sse4.2", "max_isa=avx", "max_isa=avx2"}) {
            setenv("KOKAGE_EMBREE", instructions, 1);
            const RayQueries queries(scene);
            unsetenv("KOKAGE_EMBREE");
            queries.first_hits(rays, hits, found);
            queries.occluded(rays, hidden);
            std::size_t apart = 0;
            for (std::size_t k = 0; k < count; ++k)
                apart += found[k] != usual_found[k] || hidden[k] != usual_hidden[k] ||
                         (found[k] && hits[k].triangle != usual_hits[k].triangle);
            EXPECT_LE(apart, count / 1000) << instructions;
        }
    }
}

TEST(RayQueries, ManyRaysAtOnceInAnEmptyScene) {
    const PatchScene scene;
    const RayQueries queries(scene);
    const std::vector<Ray> rays = camera_like_rays(20);
    std::vector<RayHit> hits(20);
    std::vector<std::uint8_t> found(20, 1), hidden(20, 1);
    queries.first_hits(rays, hits, found);
    queries.occluded(rays, hidden);
    EXPECT_EQ(found, std::vector<std::uint8_t>(20, 0));
    EXPECT_EQ(hidden, std::vector<std::uint8_t>(20, 0));
}

} // namespace
} // namespace kokage
