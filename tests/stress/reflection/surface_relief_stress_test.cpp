// Relief on meshes that nobody would model, and far from the origin.
#include "reflection/relief/exact_tracer.h"
#include "reflection/relief/surface_relief.h"
#include "tests/unit/common/scene_builders.h"
#include "tests/unit/reflection/relief_surfaces.h"

#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

using namespace test;

bool is_finite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Triangles between few places, many of them without area, non-manifold, inside out, with normals and texture
/// coordinates of anything.
SurfaceArrays soup(std::uint64_t seed) {
    Random random(seed);
    SurfaceArrays soup;
    for (int i = 0; i < 80; ++i) {
        soup.positions.push_back(i % 9 == 3 ? soup.positions.back() : random.uniform() * random_direction(random));
        soup.normals.push_back(i % 11 == 5 ? glm::vec3(0.f) : random_direction(random));
        const float tiles = i % 13 == 7 ? 1e6f : i % 5 == 2 ? 0 : 3;
        soup.uvs.emplace_back(random.uniform(-tiles, tiles), random.uniform(-tiles, tiles));
    }
    for (int i = 0; i < 400; ++i) {
        const auto vertex = [&] { return std::min(79u, std::uint32_t(random.uniform() * 80)); };
        soup.triangles.emplace_back(vertex(), vertex(), vertex());
    }
    return soup;
}

TEST(SurfaceReliefStress, AnyTrianglesGiveFiniteHits) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        const SurfaceArrays arrays = soup(seed);
        const HeightField field = ridged_field(20, 33);
        const auto tracer = make_exact_tracer(field);
        const ReliefShell shell = make_relief_shell(arrays.mesh(), {0.2f, seed % 2 ? 1.f : 0.f, 0.5f}, "soup");
        const TangentFrames frames = make_tangent_frames(arrays.mesh());
        const SurfaceRelief relief(shell, frames, *tracer);
        Random random(seed + 100);
        std::vector<SurfaceRay> rays;
        for (int i = 0; i < 3000; ++i) {
            SurfaceRay ray;
            ray.triangle = std::uint32_t(i) % 400;
            const glm::uvec3& t = arrays.triangles[ray.triangle];
            const float a = random.uniform(), b = random.uniform(0, 1 - a);
            const glm::vec3 at =
                a * arrays.positions[t.x] + b * arrays.positions[t.y] + (1 - a - b) * arrays.positions[t.z];
            ray.direction = random_direction(random);
            ray.distance = random.uniform(0.f, 10.f);
            ray.origin = at - ray.distance * ray.direction;
            ray.strength = i % 4 == 0 ? random.uniform() : 1;
            rays.push_back(ray);
        }
        std::vector<SurfaceHit> hits(rays.size());
        relief.trace(rays, hits);
        std::size_t within = 0;
        for (const SurfaceHit& hit : hits) {
            EXPECT_TRUE(std::isfinite(hit.way_out));
            if (!hit.found())
                continue;
            within += hit.thickness_m > 0;
            EXPECT_TRUE(is_finite(hit.position) && is_finite(hit.geometric_normal) && is_finite(hit.shading_normal));
            EXPECT_TRUE(std::isfinite(hit.uv.x) && std::isfinite(hit.uv.y));
            EXPECT_TRUE(hit.depth >= 0 && hit.depth <= 1.0001f);
            EXPECT_NEAR(hit.weights.x + hit.weights.y + hit.weights.z, 1, 1e-5);
        }
        EXPECT_GT(within, 50u);
        std::vector<std::uint8_t> hidden(hits.size());
        std::vector<float> ways_out(hits.size());
        const std::vector<glm::vec3> lights(hits.size(), random_direction(random));
        relief.occluded(hits, lights, hidden, ways_out);
        for (const float way : ways_out)
            EXPECT_TRUE(std::isfinite(way));
    }
}

TEST(SurfaceReliefStress, NoCracksAKilometreFromTheOrigin) {
    SurfaceArrays arrays = make_tube(straight_trunk());
    for (glm::vec3& p : arrays.positions)
        p += glm::vec3(1000, 700, -400); // where floats are 0.06 mm apart
    const HeightField field = ridged_field(48, 40);
    const auto tracer = make_exact_tracer(field);
    const ReliefShell shell = make_relief_shell(arrays.mesh(), {0.02f, 0, 0.3f}, "trunk");
    const TangentFrames frames = make_tangent_frames(arrays.mesh());
    const SurfaceRelief relief(shell, frames, *tracer);
    const PatchScene base = scene_of(arrays.positions, arrays.triangles);
    const RayQueries queries(base);
    auto view = camera_rays(glm::vec3(1000, 700.5f, -398), glm::vec3(1000, 700.5f, -400), 0.34f, 200);
    std::vector<SurfaceHit> hits(view.size());
    trace_from_outside(
        relief, view, entries_of(queries, view), [](std::size_t, float) { return 1.f; }, hits);
    for (const SurfaceHit& hit : hits) {
        EXPECT_TRUE(hit.found());
        EXPECT_NEAR(depth_at(field, glm::dvec2(hit.uv)), double(hit.depth), 1e-3);
    }
}

} // namespace
} // namespace kokage
