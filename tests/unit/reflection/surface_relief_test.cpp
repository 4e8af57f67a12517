// Relief on curved bark against the same relief as a mesh of a few hundred thousand triangles that Embree traces.
#include "common/services/error.h"
#include "reflection/relief/cell_by_cell.h"
#include "reflection/relief/surface_relief.h"
#include "tests/unit/common/scene_builders.h"
#include "tests/unit/reflection/relief_surfaces.h"

#include <algorithm>
#include <cstdlib>
#include <gtest/gtest.h>

namespace kokage {
namespace {

using namespace test;

constexpr int kSize = 160;

struct Difference {
    int covered = 0, both = 0, coverage = 0;   ///< pixels; coverage: hit in one of the two alone
    double distance_m = 0, normal_degrees = 0; ///< means over `both`, without edges of what stands before something
    int far_apart = 0;                         ///< hits more than a millimetre apart
};

Difference compare(const std::vector<SurfaceRay>& rays, const std::vector<SurfaceHit>& hits, const PatchScene& truth) {
    const RayQueries queries(truth);
    Difference d;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        RayHit hit;
        const bool found = queries.first_hit(rays[i].origin, rays[i].direction, 0, 1e3f, hit);
        d.covered += found;
        d.coverage += found != hits[i].found();
        if (!found || !hits[i].found())
            continue;
        const double apart = std::abs(double(hit.distance) - double(hits[i].distance));
        if (apart > 1e-3) {
            ++d.far_apart;
            continue;
        }
        ++d.both;
        d.distance_m += apart;
        d.normal_degrees +=
            std::acos(std::clamp(double(glm::dot(hit.geometric_normal, hits[i].geometric_normal)), -1., 1.));
    }
    d.distance_m /= std::max(1, d.both);
    d.normal_degrees *= 180 / kPiDouble / std::max(1, d.both);
    return d;
}

void record(const std::string& name, int value, int of) {
    testing::Test::RecordProperty(name, std::to_string(value) + " of " + std::to_string(of));
    if (std::getenv("KOKAGE_PRINT"))
        printf("%s %d of %d\n", name.c_str(), value, of);
}

struct Traced {
    SurfaceArrays arrays;
    HeightField field = ridged_field(48, 40);
    ReliefShell shell;
    TangentFrames frames;
    std::unique_ptr<ReliefTracer> tracer;
    std::unique_ptr<SurfaceRelief> relief;
    PatchScene base;
    std::unique_ptr<RayQueries> queries;

    Traced(const TubeShape& shape, float depth_m) : arrays(make_tube(shape)) {
        shell = make_relief_shell(arrays.mesh(), {depth_m, 0, 0.4f}, "tube");
        frames = make_tangent_frames(arrays.mesh());
        tracer = make_cell_by_cell_tracer(field);
        relief = std::make_unique<SurfaceRelief>(shell, frames, *tracer);
        base = scene_of(arrays.positions, arrays.triangles);
        queries = std::make_unique<RayQueries>(base);
    }
    std::vector<SurfaceHit> hits(const std::vector<SurfaceRay>& rays, float strength = 1) const {
        std::vector<SurfaceHit> result(rays.size());
        trace_from_outside(
            *relief, rays, entries_of(*queries, rays), [=](std::size_t, float) { return strength; }, result);
        return result;
    }
};

class OnTubes : public testing::TestWithParam<int> {
  protected:
    TubeShape shape() const {
        return GetParam() == 0 ? straight_trunk() : GetParam() == 1 ? cone_branch() : bent_branch();
    }
    /// From where no ray gets into the open ends.
    std::vector<SurfaceRay> rays(float azimuth) const {
        const glm::vec3 middle = shape().centre(0.5f);
        const glm::vec3 from = middle + 2.5f * glm::vec3(std::cos(azimuth), 0.1f, std::sin(azimuth));
        return camera_rays(from, middle, 0.62f, kSize);
    }
};

TEST_P(OnTubes, SeesWhatADisplacedMeshShows) {
    const Traced traced(shape(), 0.03f);
    EXPECT_EQ(traced.shell.shallow_places, 0u);
    const PatchScene fine = displaced_scene(traced.shell, traced.field, 24);
    for (const float azimuth : {1.3f, 2.2f, 4.2f, 5.f}) { // the seam is in the middle of some, at the edge of others
        const auto view = rays(azimuth);
        const Difference d = compare(view, traced.hits(view), fine);
        SCOPED_TRACE(azimuth);
        ASSERT_GT(d.covered, kSize * kSize / 8);
        EXPECT_LE(d.coverage, d.covered / 1000) << "of " << d.covered;
        EXPECT_LE(d.far_apart, d.covered / 400) << "of " << d.covered;
        EXPECT_LT(d.distance_m, 5e-5);
        EXPECT_LT(d.normal_degrees, 3.5); // the mesh's triangles are flat, and 0.3 texels wide
        record("coverage", d.coverage, d.covered);
        record("far_apart", d.far_apart, d.covered);
        record("distance_um", int(d.distance_m * 1e6), 1);
    }
}

TEST_P(OnTubes, TetrahedraStayNearTheSmoothMapping) {
    const Traced traced(shape(), 0.03f);
    const auto view = rays(2.2f);
    const Difference d = compare(view, traced.hits(view), displaced_scene(traced.shell, traced.field, 24, true));
    EXPECT_LE(d.coverage, d.covered / 500) << "of " << d.covered;
    EXPECT_LT(d.distance_m, 5e-4);
}

TEST_P(OnTubes, SilhouettesAreCut) {
    const Traced traced(shape(), 0.03f);
    const auto view = rays(2.2f);
    std::vector<SurfaceHit> relief = traced.hits(view), flat = traced.hits(view, 0);
    int lost = 0, beyond = 0;
    for (std::size_t i = 0; i < view.size(); ++i) {
        lost += flat[i].found() && !relief[i].found();
        beyond += !flat[i].found() && relief[i].found();
    }
    EXPECT_GT(lost, kSize);
    EXPECT_EQ(beyond, 0);
}

TEST_P(OnTubes, FadesWithoutPopping) {
    const Traced traced(shape(), 0.03f);
    const auto view = rays(2.2f);
    const auto flat = traced.hits(view, 0);
    for (const float strength : {1e-6f, 1e-3f, 0.01f, 0.1f}) {
        const auto hits = traced.hits(view, strength);
        int lost = 0;
        for (std::size_t i = 0; i < view.size(); ++i) {
            lost += flat[i].found() != hits[i].found();
            if (!flat[i].found() || !hits[i].found())
                continue;
            EXPECT_LE(hits[i].depth, strength * 1.0001f);
            const float cosine = -glm::dot(flat[i].geometric_normal, view[i].direction);
            if (cosine > 0.5f) {
                EXPECT_NEAR(hits[i].distance, flat[i].distance, 0.03f * strength * 1.6f / cosine + 1e-5f);
            }
        }
        EXPECT_LE(lost, 2 + int(strength * 2500)) << strength;
    }
    EXPECT_EQ(relief_strength(0.25f), 0);
    EXPECT_EQ(relief_strength(0), 0);
    EXPECT_EQ(relief_strength(0.75f), 1);
    EXPECT_LT(relief_strength(0.26f), 0.002f);
}

TEST_P(OnTubes, NoCrackAtVerticesEdgesAndSeams) {
    const SurfaceArrays arrays = make_tube(shape());
    const Traced traced(shape(), 0.03f);
    Random random(3);
    std::vector<SurfaceRay> rays;
    for (std::uint32_t t = 0; t < arrays.triangles.size(); ++t) {
        const std::uint32_t ring = t / 2 / 24;
        if (ring < 2 || ring + 2 >= 12) // near the open ends rays may leave through the border
            continue;
        for (int k = 0; k < 9; ++k) {
            glm::vec3 w(k % 3 == 0, k % 3 == 1, k % 3 == 2); // a corner, a point of an edge, an inner point
            if (k >= 3)
                w = glm::mix(w, glm::vec3(k % 3 == 2, k % 3 == 0, k % 3 == 1), random.uniform());
            if (k >= 6)
                w = glm::mix(w, glm::vec3(1.f / 3), random.uniform());
            glm::vec3 at(0.f), normal(0.f);
            for (std::size_t c = 0; c < 3; ++c) {
                at += w[c] * arrays.positions[arrays.triangles[t][c]];
                normal += w[c] * arrays.normals[arrays.triangles[t][c]];
            }
            SurfaceRay ray;
            ray.direction = -glm::normalize(normal + 0.6f * random_direction(random));
            ray.origin = at - ray.direction;
            ray.triangle = t;
            ray.distance = 1;
            rays.push_back(ray);
        }
    }
    std::vector<SurfaceHit> hits(rays.size());
    traced.relief->trace(rays, hits);
    for (const SurfaceHit& hit : hits) {
        EXPECT_TRUE(hit.found());
        EXPECT_LT(hit.distance, 1.08f);
        EXPECT_LE(hit.depth, 1);
        EXPECT_LT(hit.tetrahedra, 40u);
        EXPECT_NEAR(glm::length(hit.shading_normal), 1, 1e-5);
        EXPECT_NEAR(glm::length(hit.geometric_normal), 1, 1e-5);
        EXPECT_GT(glm::dot(hit.shading_normal, hit.geometric_normal), 0.8f); // sides of the tube are 15 degrees apart
    }
}

TEST_P(OnTubes, ShadowsAreThoseOfTheDisplacedMesh) {
    const Traced traced(shape(), 0.03f);
    const PatchScene fine = displaced_scene(traced.shell, traced.field, 24);
    const RayQueries queries(fine);
    const auto view = rays(2.2f);
    std::vector<SurfaceHit> hits;
    for (const SurfaceHit& hit : traced.hits(view))
        if (hit.found())
            hits.push_back(hit);
    const glm::vec3 to_light = glm::normalize(glm::vec3(0.7f, 0.5f, 0.5f));
    const std::vector<glm::vec3> lights(hits.size(), to_light);
    std::vector<std::uint8_t> hidden(hits.size());
    std::vector<float> ways_out(hits.size());
    traced.relief->occluded(hits, lights, hidden, ways_out);
    int wrong = 0, counted = 0, dark = 0;
    for (std::size_t i = 0; i < hits.size(); ++i) {
        // Where the light grazes, or the relief itself turns away, a mesh of flat triangles says anything.
        if (std::abs(glm::dot(hits[i].geometric_normal, to_light)) < 0.1f)
            continue;
        // Within the shell: what lies beyond may shade it too.
        const float reach = hidden[i] ? 0.1f : std::min(ways_out[i], 0.1f);
        const auto is_dark_from = [&](float lift) {
            return queries.occluded(hits[i].position + lift * hits[i].geometric_normal, to_light, 0, reach);
        };
        // What turns away from the light is dark, though rays that start above it may pass its edge.
        const bool turns_away = glm::dot(hits[i].geometric_normal, to_light) < 0,
                   is_dark = turns_away || is_dark_from(1e-4f);
        if (!turns_away && is_dark != is_dark_from(6e-4f)) // a shadow's edge
            continue;
        ++counted;
        dark += is_dark;
        wrong += is_dark != (hidden[i] != 0);
    }
    EXPECT_GT(dark, counted / 20);
    EXPECT_LE(wrong, counted / 500) << "of " << counted;
    record("wrong", wrong, counted);
}

/// A tube whose lower part has one relief, the middle another one of other depth, the top none.
TEST(SurfaceLayers, GoFromOneReliefToTheNext) {
    const SurfaceArrays tube = make_tube(straight_trunk());
    const HeightField fields[2] = {ridged_field(48, 40), ridged_field(21, 64)};
    const auto coarse = make_cell_by_cell_tracer(fields[0]), fine = make_cell_by_cell_tracer(fields[1]);
    ReliefLayers layers{{{0.03f, 0, 0.3f}, {0.015f, 0, 0.3f}, {0, 0, 0.3f}}, {}};
    for (std::size_t t = 0; t < tube.triangles.size(); ++t)
        layers.of_triangle.push_back(t < 24 * 2 * 5 ? 0 : t < 24 * 2 * 10 ? 1 : 2);
    const ReliefShell shell = make_relief_shell(tube.mesh(), layers, "tube");
    const TangentFrames frames = make_tangent_frames(tube.mesh());
    EXPECT_THROW(SurfaceRelief(shell, frames, *coarse), std::invalid_argument);
    const SurfaceRelief relief(shell, frames, {{coarse.get(), 0}, {fine.get(), 0.01f}, {}});
    const PatchScene base = scene_of(tube.positions, tube.triangles);
    const RayQueries queries(base);
    auto view = camera_rays({0, 1, 2.4f}, {0, 0.5f, 0}, 0.8f, kSize);
    std::erase_if(view, [](const SurfaceRay& ray) { return std::abs(ray.direction.x) > 0.05f; }); // on the tube
    std::vector<SurfaceHit> hits(view.size());
    trace_from_outside(
        relief, view, entries_of(queries, view), [](std::size_t, float) { return 1.f; }, hits);
    int of_layer[3] = {};
    for (const SurfaceHit& hit : hits) {
        ASSERT_TRUE(hit.found());
        const int layer = shell.prisms[hit.triangle].layer;
        ++of_layer[layer];
        EXPECT_EQ(hit.thickness_m > 0, layer < 2);
        if (layer < 2) {
            EXPECT_NEAR(depth_at(fields[layer], glm::dvec2(hit.uv)), double(hit.depth), 2e-4);
        }
    }
    EXPECT_GT(of_layer[0], 1000);
    EXPECT_GT(of_layer[1], 1000);
    EXPECT_GT(of_layer[2], 400);

    layers.of_triangle.pop_back();
    EXPECT_THROW(make_relief_shell(tube.mesh(), layers, "tube"), InputError);
}

INSTANTIATE_TEST_SUITE_P(Shapes, OnTubes, testing::Values(0, 1, 2));

} // namespace
} // namespace kokage
