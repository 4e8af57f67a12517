#include "reflection/relief/tangent_frames.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace kokage {
namespace {

/// ∂P/∂u, ∂P/∂v over one triangle.
struct Derivatives {
    glm::dvec3 u{0.}, v{0.};
    double tiles = 0; ///< signed area of the triangle in tiles, twice; 0: no derivatives
};

Derivatives derivatives(const ReliefMesh& mesh, const glm::uvec3& t) {
    const auto at = [&](std::size_t k) { return glm::dvec3(mesh.positions[t[k]]); };
    const auto uv = [&](std::size_t k) { return glm::dvec2(mesh.uvs[t[k]]); };
    const glm::dvec3 p = at(1) - at(0), q = at(2) - at(0);
    const glm::dvec2 a = uv(1) - uv(0), b = uv(2) - uv(0);
    const double tiles = a.x * b.y - a.y * b.x;
    const double edges = glm::length(a) * glm::length(b);
    // Slivers in texture space give directions of rounding only.
    if (!(std::abs(tiles) > 1e-6 * edges) || glm::length(glm::cross(p, q)) <= 1e-9 * glm::length(p) * glm::length(q))
        return {};
    return {(p * b.y - q * a.y) / tiles, (q * a.x - p * b.x) / tiles, tiles};
}

double corner_angle(const ReliefMesh& mesh, const glm::uvec3& t, std::size_t k) {
    const glm::dvec3 o(mesh.positions[t[k]]);
    const glm::dvec3 a = glm::dvec3(mesh.positions[t[(k + 1) % 3]]) - o,
                     b = glm::dvec3(mesh.positions[t[(k + 2) % 3]]) - o;
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

/// What corners must share to share a frame: place, normal, texture coordinate but for whole tiles, handedness.
using CornerKey = std::array<std::int64_t, 7>;

CornerKey corner_key(const ReliefMesh& mesh, const WeldedPlaces& places, std::uint32_t vertex, double tiles) {
    constexpr double kSteps = 4096; // of a tile: coordinates of 50 tiles have no more digits to tell apart by
    const auto rest = [](float x) {
        return std::int64_t(std::lround((double(x) - std::floor(double(x))) * kSteps)) % std::int64_t(kSteps);
    };
    const auto step = [](float x) { return std::int64_t(std::lround(double(x) * kSteps)); };
    const glm::vec3 n = mesh.normals[vertex];
    const glm::vec2 uv = mesh.uvs[vertex];
    return {places.place_of_vertex[vertex],    step(n.x), step(n.y), step(n.z), rest(uv.x), rest(uv.y),
            tiles > 0 ? 1 : tiles < 0 ? -1 : 0};
}

struct Sums {
    glm::dvec3 u{0.}, v{0.}; ///< weight x unit direction
    double length_u = 0, length_v = 0, weight = 0;
    glm::dvec3 normal{0.};
};

glm::dvec3 unit_or_zero(const glm::dvec3& v) {
    const double length = glm::length(v);
    return length > 0 ? v / length : glm::dvec3(0.);
}

TangentFrame frame_of(const Sums& sums) {
    TangentFrame frame;
    frame.normal = glm::vec3(sums.normal);
    const glm::dvec3 u = unit_or_zero(sums.u), v = unit_or_zero(sums.v);
    if (sums.weight > 0 && glm::length(glm::cross(u, v)) > 1e-6) {
        frame.along_u = glm::vec3(u * (sums.length_u / sums.weight));
        frame.along_v = glm::vec3(v * (sums.length_v / sums.weight));
    }
    return frame;
}

} // namespace

TangentFrames make_tangent_frames(const ReliefMesh& mesh) {
    const WeldedPlaces places = weld_places(mesh.positions);
    TangentFrames result;
    result.corners.resize(mesh.triangles.size());
    std::map<CornerKey, std::uint32_t> known;
    constexpr std::uint32_t kNone = 0xffffffffu;
    std::vector<std::array<std::uint32_t, 3>> of_vertex(mesh.positions.size(), {kNone, kNone, kNone}); // by handedness
    std::vector<Sums> sums;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const glm::uvec3& triangle = mesh.triangles[t];
        const Derivatives d = derivatives(mesh, triangle);
        for (std::size_t k = 0; k < 3; ++k) {
            std::uint32_t& frame = of_vertex[triangle[k]][d.tiles > 0 ? 0 : d.tiles < 0 ? 1 : 2];
            if (frame == kNone) {
                frame = known.try_emplace(corner_key(mesh, places, triangle[k], d.tiles), std::uint32_t(sums.size()))
                            .first->second;
                if (frame == sums.size())
                    sums.emplace_back().normal = unit_or_zero(glm::dvec3(mesh.normals[triangle[k]]));
            }
            result.corners[t][k] = frame;
            if (d.tiles == 0)
                continue;
            Sums& s = sums[frame];
            const auto laid = [&](const glm::dvec3& v) { return unit_or_zero(v - glm::dot(v, s.normal) * s.normal); };
            const double weight = corner_angle(mesh, triangle, k);
            s.u += weight * laid(d.u);
            s.v += weight * laid(d.v);
            s.length_u += weight * glm::length(d.u);
            s.length_v += weight * glm::length(d.v);
            s.weight += weight;
        }
    }
    for (const Sums& s : sums)
        result.frames.push_back(frame_of(s));
    return result;
}

TangentFrame interpolate(const TangentFrames& frames, std::size_t triangle, const glm::vec3& weights) {
    TangentFrame result;
    glm::vec3 normal(0.f);
    bool has_tangents = true;
    for (std::size_t k = 0; k < 3; ++k) {
        const TangentFrame& f = frames.frames[frames.corners[triangle][k]];
        normal += weights[k] * f.normal;
        result.along_u += weights[k] * f.along_u;
        result.along_v += weights[k] * f.along_v;
        has_tangents = has_tangents && f.has_tangents();
    }
    const float length = glm::length(normal);
    result.normal = length > 0 ? normal / length : frames.frames[frames.corners[triangle][0]].normal;
    if (!has_tangents)
        result.along_u = result.along_v = glm::vec3(0.f);
    return result;
}

ReliefScale relief_scale(const TangentFrame& frame, float depth_m) {
    ReliefScale scale;
    if (frame.has_tangents())
        scale.tile_m = {glm::length(frame.along_u), glm::length(frame.along_v)};
    scale.depth_m = depth_m;
    return scale;
}

glm::vec3 relief_normal(const TangentFrame& frame, const glm::vec2& slope, float depth_m) {
    // ∇u and ∇v on the tangent plane: at right angles to the other tangent, 1 along their own.
    const glm::vec3 across_v = glm::cross(frame.along_v, frame.normal),
                    across_u = glm::cross(frame.normal, frame.along_u);
    const float area = glm::dot(frame.along_u, across_v);
    if (!frame.has_tangents() || area == 0)
        return frame.normal;
    return glm::normalize(frame.normal + depth_m / area * (slope.x * across_v + slope.y * across_u));
}

std::vector<float> tile_sizes(const ReliefMesh& mesh, const WeldedPlaces& places) {
    std::vector<double> sizes(places.count), areas(places.count);
    for (const glm::uvec3& t : mesh.triangles) {
        const Derivatives d = derivatives(mesh, t);
        if (d.tiles == 0)
            continue;
        const double tile = glm::length(glm::cross(d.u, d.v)), area = std::abs(d.tiles) * tile;
        for (std::size_t k = 0; k < 3; ++k) {
            sizes[places.place_of_vertex[t[k]]] += area * std::sqrt(tile);
            areas[places.place_of_vertex[t[k]]] += area;
        }
    }
    std::vector<float> result(places.count);
    for (std::size_t i = 0; i < result.size(); ++i)
        result[i] = areas[i] > 0 ? float(sizes[i] / areas[i]) : 0.f;
    return result;
}

} // namespace kokage
