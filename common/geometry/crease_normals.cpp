#include "common/geometry/crease_normals.h"
#include "common/services/error.h"

#include <cmath>
#include <string>

namespace kokage {
namespace {

constexpr std::size_t kMostCompared = 256;

/// Twice the area times the unit normal, in double: tiny triangles have normals, too.
std::vector<glm::dvec3> area_normals(const std::vector<glm::vec3>& positions,
                                     const std::vector<glm::uvec3>& triangles) {
    std::vector<glm::dvec3> result;
    for (const glm::uvec3& t : triangles) {
        const glm::dvec3 a = positions[t.x], b = positions[t.y], c = positions[t.z];
        result.push_back(glm::cross(b - a, c - a));
    }
    return result;
}

/// Triangles at each vertex: those of vertex v are at[first[v]] ... at[first[v + 1] - 1].
struct TrianglesAtVertices {
    std::vector<std::uint32_t> first, at;
};

TrianglesAtVertices triangles_at(std::size_t vertices, const std::vector<glm::uvec3>& triangles) {
    TrianglesAtVertices result;
    result.first.assign(vertices + 1, 0);
    for (const glm::uvec3& t : triangles)
        for (std::size_t k = 0; k < 3; ++k)
            ++result.first[t[k] + 1];
    for (std::size_t v = 0; v < vertices; ++v)
        result.first[v + 1] += result.first[v];
    std::vector<std::uint32_t> next(result.first.begin(), result.first.end() - 1);
    result.at.resize(3 * triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k)
            result.at[next[triangles[t][k]]++] = std::uint32_t(t);
    return result;
}

bool is_within(const glm::dvec3& a, const glm::dvec3& b, double cosine) {
    const double lengths = glm::length(a) * glm::length(b);
    return lengths > 0 && glm::dot(a, b) >= cosine * lengths;
}

} // namespace

CreasedMesh crease_normals(const std::vector<glm::vec3>& positions, const std::vector<glm::uvec3>& triangles,
                           float angle) {
    for (const glm::uvec3& t : triangles)
        for (std::size_t k = 0; k < 3; ++k)
            if (t[k] >= positions.size())
                throw InputError("a triangle has vertex " + std::to_string(t[k]) + " of " +
                                 std::to_string(positions.size()));
    const std::vector<glm::dvec3> flat = area_normals(positions, triangles);
    const TrianglesAtVertices neighbours = triangles_at(positions.size(), triangles);
    const double cosine = std::cos(double(angle));
    CreasedMesh mesh;
    std::vector<std::vector<std::uint32_t>> made(positions.size()); // vertices of the new mesh at each old one
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        glm::uvec3 corners(0);
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t vertex = triangles[t][k];
            const std::uint32_t begin = neighbours.first[vertex], end = neighbours.first[vertex + 1];
            const bool all = end - begin > kMostCompared || !(glm::length(flat[t]) > 0);
            glm::dvec3 sum(0.0);
            for (std::uint32_t n = begin; n < end; ++n)
                if (all || is_within(flat[t], flat[neighbours.at[n]], cosine))
                    sum += flat[neighbours.at[n]];
            const double length = glm::length(sum);
            const glm::vec3 normal = length > 0 ? glm::vec3(sum / length) : glm::vec3(0, 1, 0);
            std::uint32_t corner = ~0u;
            for (const std::uint32_t candidate : made[vertex])
                if (mesh.normals[candidate] == normal)
                    corner = candidate;
            if (corner == ~0u) {
                corner = std::uint32_t(mesh.positions.size());
                mesh.positions.push_back(positions[vertex]);
                mesh.normals.push_back(normal);
                made[vertex].push_back(corner);
            }
            corners[k] = corner;
        }
        mesh.triangles.push_back(corners);
    }
    return mesh;
}

} // namespace kokage
