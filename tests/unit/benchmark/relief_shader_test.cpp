// Our GLSL finds what the truth finds: relief on a plane.
#include "common/services/random.h"
#include "reflection/relief/cell_by_cell.h"
#include "reflection/relief/exact_tracer.h"
#include "tests/benchmark/relief_maps.h"
#include "tests/unit/benchmark/relief_shader.h"

#include <chrono>
#include <cmath>
#include <cstdlib>

namespace kokage {
namespace {

using test::kRaysARow;
using test::source_of;

constexpr int kSize = kRaysARow;
constexpr float kTexels = 0.5f; ///< hits nearer than this are the same

/// Hits of rays on the GPU.
struct GpuHits {
    std::vector<glm::vec4> first, second; ///< found, t, u, v; depth, slopes, reads
};

const char* const kPlaneMain = R"(
uniform highp sampler2D origins, directions;
layout(location = 0) out highp vec4 first;
layout(location = 1) out highp vec4 second;
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    highp vec4 origin = texelFetch(origins, at, 0), direction = texelFetch(directions, at, 0);
    ReliefHit hit = reliefTrace(origin.xyz, direction.xyz, direction.w);
    first = vec4(hit.found ? 1.0 : 0.0, hit.t, hit.coordinate);
    second = vec4(hit.depth, hit.slope, float(hit.reads));
}
)";

class OnPlane : public test::ReliefShader {
  protected:
    void SetUp() override {
        ReliefShader::SetUp();
        if (gl_)
            gl_->use(source_of("relief.glsl") + kPlaneMain, 2);
    }
    GpuHits trace(const HeightField& field, const std::vector<ReliefRay>& rays) {
        gl_->forget_textures();
        const ReliefTextures textures = make_relief_textures(field);
        set_relief(field, upload(textures.depths), upload(textures.planes), textures);
        std::vector<glm::vec4> origins, directions;
        for (const ReliefRay& ray : rays) {
            origins.emplace_back(ray.origin, 0);
            directions.emplace_back(ray.direction, ray.t_most);
        }
        gl_->set("origins", upload(origins));
        gl_->set("directions", upload(directions));
        auto values = gl_->draw(kSize, int(rays.size()) / kSize);
        return {std::move(values[0]), std::move(values[1])};
    }
};

float texels_apart(const HeightField& field, const glm::vec2& a, const glm::vec2& b) {
    glm::vec2 apart = a - b;
    if (field.wrap == HeightWrap::repeat)
        apart -= glm::round(apart);
    return glm::length(apart * glm::vec2(field.width, field.height));
}

/// How far a differing pair of answers is from a tie, in depth: how deep the surface that one of them passed reaches
/// into the other's ray.
double deepest_missed(const HeightField& field, const ReliefRay& ray, const TrueReliefHit& truth, bool found,
                      double t) {
    const double texel = 0.5 / std::max(1e-9f, std::max(std::abs(ray.direction.x) * float(field.width),
                                                        std::abs(ray.direction.y) * float(field.height)));
    if (found && t < truth.t) // hit something in the air: how high above?
        return -greatest_depth_below(field, ray, std::max(0., t - texel), t + texel);
    return greatest_depth_below(field, ray, 0, found ? t - texel : 1e9);
}

struct Agreement {
    int rays = 0, found = 0, differ = 0;
    double farthest_from_tie = 0, reads = 0;
};

Agreement compare(const HeightField& field, const std::vector<ReliefRay>& rays, const GpuHits& gpu) {
    Agreement a;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const TrueReliefHit truth = true_relief_hit(field, rays[i]);
        const bool found = gpu.first[i].x > 0.5f;
        ++a.rays;
        a.found += truth.found();
        a.reads += double(gpu.second[i].w);
        const glm::vec2 at(gpu.first[i].z, gpu.first[i].w);
        if (found == truth.found() && (!found || texels_apart(field, at, glm::vec2(truth.coordinate)) <= kTexels)) {
            if (found) {
                EXPECT_NEAR(gpu.second[i].x, truth.depth, 2e-3) << i;
            }
            continue;
        }
        ++a.differ;
        a.farthest_from_tie =
            std::max(a.farthest_from_tie, deepest_missed(field, rays[i], truth, found, double(gpu.first[i].y)));
    }
    return a;
}

TEST_F(OnPlane, FindsWhatTheTruthFindsAtEveryAngle) {
    for (const ReliefMap map : {ReliefMap::bark, ReliefMap::spikes, ReliefMap::low}) {
        const HeightField field = make_relief_map(map, 256, 256);
        const auto tracer = make_exact_tracer(field);
        for (const float degrees : {10.f, 45.f, 70.f, 85.f}) {
            std::vector<ReliefRay> rays;
            Random random(7);
            const float angle = degrees * kPi / 180;
            for (int i = 0; i < kSize * kSize; ++i) {
                const float azimuth = random.uniform(0.f, 2 * kPi);
                const glm::vec3 d(std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth),
                                  -std::cos(angle));
                rays.push_back(relief_ray({random.uniform(), random.uniform()}, d, {{1, 1}, kBenchReliefDepth}));
            }
            const auto begin = std::chrono::steady_clock::now();
            const GpuHits hits = trace(field, rays);
            const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
            const Agreement a = compare(field, rays, hits);
            std::vector<ReliefHit> ours(rays.size());
            tracer->trace(rays, ours);
            double our_reads = 0;
            for (const ReliefHit& hit : ours)
                our_reads += hit.reads;
            SCOPED_TRACE(testing::Message() << relief_map_name(map) << " at " << degrees << " degrees");
            EXPECT_EQ(a.found, a.rays);
            EXPECT_NEAR(a.reads, our_reads, 0.1 * our_reads); // the same way through the hierarchy
            EXPECT_LE(a.differ, a.rays / 2000);
            EXPECT_LT(a.farthest_from_tie, 2e-6); // single precision
            if (std::getenv("KOKAGE_PRINT"))
                printf("%s %g: %d of %d differ, %.1e from a tie, %.2f reads (ours %.2f), %.2f s\n",
                       relief_map_name(map).data(), double(degrees), a.differ, a.rays, a.farthest_from_tie,
                       a.reads / a.rays, our_reads / a.rays, seconds.count());
        }
    }
}

TEST_F(OnPlane, OddRaysAndMaps) {
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 7}, {5, 3}, {64, 24}, {33, 100}})
        for (const HeightWrap wrap : {HeightWrap::repeat, HeightWrap::clamp}) {
            HeightField field{width, height, wrap, {}};
            Random random(std::uint64_t(width * 1000 + height));
            for (int i = 0; i < width * height; ++i)
                field.depths.push_back(random.uniform());
            std::vector<ReliefRay> rays;
            for (int i = 0; i < kSize * 20; ++i) {
                ReliefRay ray{{random.uniform(-2.f, 3.f), random.uniform(-2.f, 3.f), random.uniform(-1.f, 1.2f)},
                              {random.uniform(-1.f, 1.f), random.uniform(-1.f, 1.f), random.uniform(-1.f, 1.f)},
                              i % 5 == 0 ? random.uniform() : 1e30f};
                if (i % 7 == 0)
                    ray.direction.x = 0;
                if (i % 11 == 0)
                    ray.direction.y = 0;
                if (i % 13 == 0)
                    ray.direction.z = 0;
                if (i % 17 == 0)
                    ray.direction *= 100;
                if (i % 19 == 0)
                    ray.origin = {float(i % width) / float(width), 0.5f / float(height), 0};
                rays.push_back(ray);
            }
            const Agreement a = compare(field, rays, trace(field, rays));
            SCOPED_TRACE(testing::Message()
                         << width << " x " << height << (wrap == HeightWrap::clamp ? " clamped" : ""));
            EXPECT_GT(a.found, a.rays / 4);
            EXPECT_LE(a.differ, a.rays / 1000);
            EXPECT_LT(a.farthest_from_tie, 1e-5);
        }
}

} // namespace
} // namespace kokage
