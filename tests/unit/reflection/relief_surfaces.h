#pragma once
// Trunks and branches to lay relief on, and the same relief as a finely displaced mesh that Embree traces: the truth.
#include "common/services/random.h"
#include "common/trace/ray_queries.h"
#include "reflection/relief/bilinear_cell.h"
#include "reflection/relief/surface_entries.h"

#include <cmath>
#include <functional>
#include <memory>

namespace kokage::test {

struct SurfaceArrays {
    std::vector<glm::vec3> positions, normals;
    std::vector<glm::vec2> uvs;
    std::vector<glm::uvec3> triangles;

    ReliefMesh mesh() const { return {positions, normals, uvs, triangles}; }
};

/// A tube of `rings` x `sides` quads around a centre line, with a seam of texture coordinates where u is 0 and
/// `tiles_around`. `centre(t)` and `radius(t)`: t = 0 .. 1 along it; it stays in the plane z = 0.
struct TubeShape {
    std::function<glm::vec3(float)> centre;
    std::function<float(float)> radius;
    int sides = 24, rings = 12;
    float tiles_around = 3, tiles_along = 2;
};

inline SurfaceArrays make_tube(const TubeShape& shape) {
    SurfaceArrays tube;
    for (int j = 0; j <= shape.rings; ++j) {
        const float t = float(j) / float(shape.rings), e = 1e-3f;
        const glm::vec3 along = glm::normalize(shape.centre(t + e) - shape.centre(t - e)), z(0, 0, 1);
        const glm::vec3 x = glm::normalize(glm::cross(along, z));
        const float slope =
            (shape.radius(t + e) - shape.radius(t - e)) / glm::distance(shape.centre(t + e), shape.centre(t - e));
        for (int i = 0; i <= shape.sides; ++i) {
            const float angle = 2 * kPi * float(i % shape.sides) / float(shape.sides);
            const glm::vec3 outwards = std::cos(angle) * x - std::sin(angle) * z;
            tube.positions.push_back(shape.centre(t) + shape.radius(t) * outwards);
            tube.normals.push_back(glm::normalize(outwards - slope * along));
            tube.uvs.emplace_back(float(i) / float(shape.sides) * shape.tiles_around, 5.3f - t * shape.tiles_along);
        }
    }
    const auto vertex = [&](int i, int j) { return std::uint32_t(j * (shape.sides + 1) + i); };
    for (int j = 0; j < shape.rings; ++j)
        for (int i = 0; i < shape.sides; ++i) {
            tube.triangles.emplace_back(vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1));
            tube.triangles.emplace_back(vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1));
        }
    return tube;
}

inline TubeShape straight_trunk() {
    return {[](float t) { return glm::vec3(0, t, 0); }, [](float) { return 0.2f; }};
}
inline TubeShape cone_branch() {
    return {[](float t) { return glm::vec3(0, t, 0); }, [](float t) { return 0.2f - 0.15f * t; }};
}
inline TubeShape bent_branch() {
    return {[](float t) { return glm::vec3(0.6f - 0.6f * std::cos(1.6f * t), 0.6f * std::sin(1.6f * t), 0); },
            [](float t) { return 0.16f - 0.06f * t; }};
}

/// Ridges that wander, with furrows between them, and knots: periodic.
inline HeightField ridged_field(int width, int height) {
    HeightField field{width, height, HeightWrap::repeat, {}};
    Random random(4);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float u = 2 * kPi * (float(x) + 0.5f) / float(width), v = 2 * kPi * (float(y) + 0.5f) / float(height);
            const float ridge = std::abs(std::sin(2 * u + 0.8f * std::sin(v) + 0.4f * std::sin(2 * v - u)));
            const float bumps = 0.5f + 0.5f * std::sin(5 * v + std::sin(2 * u)) * std::cos(3 * u);
            field.depths.push_back(
                glm::clamp(0.95f - 0.75f * ridge - 0.2f * bumps + random.uniform(0.f, 0.05f), 0.f, 1.f));
        }
    return field;
}

inline double depth_at(const HeightField& field, const glm::dvec2& uv) {
    const glm::dvec2 at = uv * glm::dvec2(field.width, field.height) - 0.5, cell = glm::floor(at);
    const BilinearCell bilinear = bilinear_cell(field, (long long)cell.x, (long long)cell.y);
    return bilinear.depth(at.x - cell.x, at.y - cell.y);
}

/// One patch of all triangles: what RayQueries traces.
inline PatchScene scene_of(std::vector<glm::vec3> positions, std::vector<glm::uvec3> triangles) {
    PatchScene scene;
    scene.optics = {{}};
    scene.patches = {Patch{0, std::uint32_t(triangles.size()), 0, PatchKind::leaf, 0}};
    scene.leaf_count = 1;
    scene.triangle_patch.assign(triangles.size(), 0);
    scene.positions = std::move(positions);
    scene.triangles = std::move(triangles);
    return scene;
}

/// Every triangle cut into cuts x cuts, each vertex moved to its depth: as the shell maps it, or (`smooth`) straight
/// inwards along the normals interpolated over the triangle, which is what the shell's tetrahedra approximate.
inline PatchScene displaced_scene(const ReliefShell& shell, const HeightField& field, int cuts, bool smooth = false) {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
    for (const ReliefShell::Prism& prism : shell.prisms) {
        const auto first = std::uint32_t(positions.size());
        const bool odd = (prism.corners[1] + 3 - prism.corners[0]) % 3 != 1;
        const auto index = [&](int i, int j) { return first + std::uint32_t(i * (i + 1) / 2 + j); };
        for (int i = 0; i <= cuts; ++i)
            for (int j = 0; j <= i; ++j) {
                const glm::dvec3 w = glm::dvec3(cuts - i, i - j, j) / double(cuts);
                glm::dvec2 uv(0.);
                glm::dvec3 point(0.);
                for (std::size_t k = 0; k < 3; ++k)
                    uv += w[k] * glm::dvec2(prism.uvs[k]);
                const double depth = depth_at(field, uv);
                for (std::size_t k = 0; k < 3; ++k)
                    point += w[k] * glm::mix(glm::dvec3(shell.outer[prism.places[k]]),
                                             glm::dvec3(shell.inner[prism.places[k]]), depth);
                positions.push_back(glm::vec3(smooth ? point : shell_point(shell, prism, w, depth)));
            }
        const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
            triangles.push_back(odd ? glm::uvec3(a, c, b) : glm::uvec3(a, b, c));
        };
        for (int i = 0; i < cuts; ++i)
            for (int j = 0; j <= i; ++j) {
                add(index(i, j), index(i + 1, j), index(i + 1, j + 1));
                if (j < i)
                    add(index(i, j), index(i + 1, j + 1), index(i, j + 1));
            }
    }
    return scene_of(std::move(positions), std::move(triangles));
}

/// A pinhole camera's rays.
inline std::vector<SurfaceRay> camera_rays(const glm::vec3& eye, const glm::vec3& at, float width_m, int size) {
    std::vector<SurfaceRay> rays;
    const glm::vec3 forward = at - eye, right = glm::normalize(glm::cross(forward, glm::vec3(0, 1, 0)));
    const glm::vec3 up = glm::normalize(glm::cross(right, forward));
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const float a = (float(x) + 0.5f) / float(size) - 0.5f, b = 0.5f - (float(y) + 0.5f) / float(size);
            SurfaceRay ray;
            ray.origin = eye;
            ray.direction = glm::normalize(forward + width_m * (a * right + b * up));
            rays.push_back(ray);
        }
    return rays;
}

/// Entries from a mesh in Embree.
inline NextSurfaceEntry entries_of(const RayQueries& queries, const std::vector<SurfaceRay>& rays) {
    return [&](std::size_t i, float after, float before, SurfaceEntry& entry) {
        for (RayHit hit; queries.first_hit(rays[i].origin, rays[i].direction,
                                           after > 0 ? after * (1 + 1e-6f) + 1e-6f : 0, before, hit);
             after = hit.distance)
            if (glm::dot(hit.geometric_normal, rays[i].direction) < 0) {
                entry = {hit.triangle, hit.distance};
                return true;
            }
        return false;
    };
}

} // namespace kokage::test
