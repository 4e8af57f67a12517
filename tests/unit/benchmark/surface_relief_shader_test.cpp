// Our GLSL finds what SurfaceRelief finds: relief on a trunk, a cone and a bent branch, and its shadows.
#include "reflection/relief/exact_tracer.h"
#include "tests/benchmark/relief_maps.h"
#include "tests/unit/benchmark/relief_shader.h"
#include "tests/unit/reflection/relief_surfaces.h"

#include <bit>
#include <cstdlib>

namespace kokage {
namespace {

using namespace test;

const char* const kSurfaceMain = R"(
uniform highp sampler2D entries, directions;
uniform highp vec3 toLight;
layout(location = 0) out highp vec4 first;
layout(location = 1) out highp vec4 second;
layout(location = 2) out highp vec4 third;
layout(location = 3) out highp vec4 fourth;
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    highp vec4 entry = texelFetch(entries, at, 0), direction = texelFetch(directions, at, 0);
    SurfaceHit hit = surfaceTrace(entry.xyz, direction.xyz, floatBitsToUint(entry.w), direction.w);
    highp float wayOut = 0.0;
    bool dark = hit.found && surfaceOccluded(hit, toLight, direction.w, wayOut);
    first = vec4(hit.found ? 1.0 : 0.0, hit.distance, hit.uv);
    second = vec4(hit.depth, hit.geometricNormal);
    third = vec4(dark ? 1.0 : 0.0, hit.shadingNormal);
    fourth = vec4(float(hit.reads), float(hit.tetrahedra), float(hit.prism), wayOut);
}
)";

class OnSurface : public ReliefShader {};

TEST_F(OnSurface, CompilesForWebGl) {
    gl_->use(source_of("relief.glsl") + source_of("surface_relief.glsl") + kSurfaceMain, 4,
             GlContext::Language::glsl_es_300);
}

TEST_F(OnSurface, FindsWhatOurTracerFinds) {
    gl_->use(source_of("relief.glsl") + source_of("surface_relief.glsl") + kSurfaceMain, 4);
    const HeightField field = make_relief_map(ReliefMap::bark, 128, 128);
    const auto tracer = make_exact_tracer(field);
    const ReliefTextures textures = make_relief_textures(field);
    set_relief(field, upload(textures.depths), upload(textures.planes), textures);
    const glm::vec3 to_light = glm::normalize(glm::vec3(0.5f, 0.6f, 0.6f));
    gl_->set("toLight", to_light);
    for (int which = 0; which < 3; ++which) {
        const TubeShape shape = which == 0 ? straight_trunk() : which == 1 ? cone_branch() : bent_branch();
        const SurfaceArrays arrays = make_tube(shape);
        const ReliefShell shell = make_relief_shell(arrays.mesh(), {0.03f, 0, 0.3f}, "tube");
        const TangentFrames frames = make_tangent_frames(arrays.mesh());
        const SurfaceRelief relief(shell, frames, *tracer);
        const SurfaceTextures surface = make_surface_textures(shell, frames);
        gl_->set("surfacePlaces", upload(surface.places));
        gl_->set("surfaceFrames", upload(surface.frames));
        gl_->set("surfacePrisms", upload(surface.prisms));

        const PatchScene base = scene_of(arrays.positions, arrays.triangles);
        const RayQueries queries(base);
        const glm::vec3 middle = shape.centre(0.5f);
        std::vector<SurfaceRay> rays;
        std::vector<glm::vec4> entries, directions;
        for (SurfaceRay ray : camera_rays(middle + glm::vec3(-1.4f, 0.3f, 1.9f), middle, 0.62f, kRaysARow)) {
            RayHit hit;
            ray.strength = rays.size() % 3 == 0 ? 0.5f : 1;
            if (queries.first_hit(ray.origin, ray.direction, 0, 1e3f, hit) &&
                glm::dot(hit.geometric_normal, ray.direction) < 0) {
                ray.origin += hit.distance * ray.direction;
                ray.triangle = hit.triangle;
                rays.push_back(ray);
                entries.emplace_back(ray.origin, std::bit_cast<float>(ray.triangle));
                directions.emplace_back(ray.direction, ray.strength);
            }
        }
        const std::size_t rows = rays.size() / kRaysARow, count = rows * kRaysARow;
        ASSERT_GT(count, 7000u);
        entries.resize(count);
        directions.resize(count);
        rays.resize(count);
        gl_->set("entries", upload(entries));
        gl_->set("directions", upload(directions));
        const auto gpu = gl_->draw(kRaysARow, int(rows));

        std::vector<SurfaceHit> hits(count);
        relief.trace(rays, hits);
        std::vector<std::uint8_t> hidden(count);
        std::vector<float> ways_out(count);
        const std::vector<glm::vec3> lights(count, to_light);
        relief.occluded(hits, lights, hidden, ways_out);
        std::size_t differ = 0, shadows_differ = 0, found = 0, missed = 0;
        double normals = 0, reads = 0, our_reads = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const SurfaceHit& hit = hits[i];
            const bool gpu_found = gpu[0][i].x > 0.5f;
            missed += !hit.found();
            const glm::vec2 apart = (glm::vec2(gpu[0][i].z, gpu[0][i].w) - hit.uv) * 128.f;
            if (gpu_found != hit.found() || (gpu_found && glm::length(apart) > 0.5f)) {
                ++differ;
                continue;
            }
            if (!gpu_found)
                continue;
            ++found;
            EXPECT_NEAR(gpu[0][i].y, hit.distance, 1e-3f);
            EXPECT_NEAR(gpu[1][i].x, hit.depth, 5e-3f);
            normals += glm::distance(glm::vec3(gpu[1][i].y, gpu[1][i].z, gpu[1][i].w), hit.geometric_normal) +
                       glm::distance(glm::vec3(gpu[2][i].y, gpu[2][i].z, gpu[2][i].w), hit.shading_normal);
            shadows_differ += (gpu[2][i].x > 0.5f) != (hidden[i] != 0);
            reads += double(gpu[3][i].x);
            our_reads += hit.reads;
        }
        if (std::getenv("KOKAGE_PRINT"))
            printf("shape %d: %zu of %zu differ, %zu shadows, %zu left, normals %.1e, reads %.2f (ours %.2f)\n", which,
                   differ, count, shadows_differ, missed, normals / double(found), reads / double(found),
                   our_reads / double(found));
        SCOPED_TRACE(which);
        EXPECT_GT(missed, 5u); // beyond the silhouette
        EXPECT_LE(differ, count / 2000);
        EXPECT_LE(shadows_differ, count / 500);
        EXPECT_LT(normals / double(found), 2e-3);
    }
}

} // namespace
} // namespace kokage
