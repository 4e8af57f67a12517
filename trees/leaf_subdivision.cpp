#include "trees/leaf_subdivision.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace kokage {
namespace {

class Subdivision {
  public:
    explicit Subdivision(VertexArrays vertices) : vertices_(vertices) {}

    void halve(std::vector<glm::uvec3> triangles, int times) {
        const double total = area(triangles);
        if (times == 0 || !(total > 0)) {
            pieces.push_back(std::move(triangles));
            return;
        }
        bisect_large(triangles, total / 6);
        const std::size_t middle = sort_along_longest_extent(triangles, total);
        halve({triangles.begin(), triangles.begin() + std::ptrdiff_t(middle)}, times - 1);
        halve({triangles.begin() + std::ptrdiff_t(middle), triangles.end()}, times - 1);
    }

    std::vector<std::vector<glm::uvec3>> pieces;

  private:
    double area(const glm::uvec3& t) const {
        const auto& p = vertices_.positions;
        return 0.5 * glm::length(
                         glm::cross(glm::dvec3(p[t.y]) - glm::dvec3(p[t.x]), glm::dvec3(p[t.z]) - glm::dvec3(p[t.x])));
    }
    double area(const std::vector<glm::uvec3>& triangles) const {
        double sum = 0;
        for (const auto& t : triangles)
            sum += area(t);
        return sum;
    }
    glm::vec3 centroid(const glm::uvec3& t) const {
        const auto& p = vertices_.positions;
        return (p[t.x] + p[t.y] + p[t.z]) / 3.f;
    }

    /// Halves triangles at the middle of their longest edge until none is larger than `limit`.
    void bisect_large(std::vector<glm::uvec3>& triangles, double limit) {
        for (std::size_t i = 0; i < triangles.size();) {
            if (!(area(triangles[i]) > limit)) {
                ++i;
                continue;
            }
            const glm::uvec3 t = triangles[i];
            std::size_t longest = 0;
            float length = -1;
            for (std::size_t k = 0; k < 3; ++k) {
                const float d = glm::distance(vertices_.positions[t[k]], vertices_.positions[t[(k + 1) % 3]]);
                if (d > length) {
                    length = d;
                    longest = k;
                }
            }
            const std::uint32_t a = t[longest], b = t[(longest + 1) % 3], c = t[(longest + 2) % 3], m = midpoint(a, b);
            triangles[i] = {a, m, c};
            triangles.insert(triangles.begin() + std::ptrdiff_t(i) + 1, {m, b, c});
        }
    }

    std::uint32_t midpoint(std::uint32_t a, std::uint32_t b) {
        const auto [entry, is_new] =
            midpoints_.try_emplace(std::minmax(a, b), std::uint32_t(vertices_.positions.size()));
        if (is_new) {
            const glm::vec3 normal = vertices_.normals[a] + vertices_.normals[b];
            const float length = glm::length(normal);
            const glm::vec3 position = 0.5f * vertices_.positions[a] + 0.5f * vertices_.positions[b];
            vertices_.normals.push_back(length > 0 ? normal / length : vertices_.normals[a]);
            vertices_.positions.push_back(position);
            if (!vertices_.uvs.empty())
                vertices_.uvs.push_back(0.5f * (vertices_.uvs[a] + vertices_.uvs[b]));
        }
        return entry->second;
    }

    /// Sorts by centroid along the longest extent; returns how many triangles make up the half nearest to half of the
    /// area.
    std::size_t sort_along_longest_extent(std::vector<glm::uvec3>& triangles, double total) const {
        const glm::vec3 axis = longest_extent(triangles);
        std::stable_sort(triangles.begin(), triangles.end(), [&](const glm::uvec3& a, const glm::uvec3& b) {
            return glm::dot(centroid(a), axis) < glm::dot(centroid(b), axis);
        });
        double before = 0;
        for (std::size_t i = 0; i < triangles.size(); ++i) {
            const double here = area(triangles[i]);
            if (before + 0.5 * here >= 0.5 * total)
                return std::clamp<std::size_t>(i, 1, triangles.size() - 1);
            before += here;
        }
        return triangles.size() / 2;
    }

    /// The direction between the two corners that lie farthest apart, found in two sweeps (exact enough to choose a
    /// cut).
    glm::vec3 longest_extent(const std::vector<glm::uvec3>& triangles) const {
        const auto farthest_from = [&](const glm::vec3& from) {
            glm::vec3 best = from;
            float distance = -1;
            for (const auto& t : triangles)
                for (std::size_t k = 0; k < 3; ++k)
                    if (const float d = glm::distance(vertices_.positions[t[k]], from); d > distance) {
                        distance = d;
                        best = vertices_.positions[t[k]];
                    }
            return best;
        };
        const glm::vec3 one = farthest_from(vertices_.positions[triangles[0].x]);
        return farthest_from(one) - one;
    }

    VertexArrays vertices_;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> midpoints_;
};

} // namespace

std::vector<std::vector<glm::uvec3>> subdivide_leaf(std::vector<glm::uvec3> triangles, int levels,
                                                    VertexArrays vertices) {
    Subdivision subdivision(vertices);
    subdivision.halve(std::move(triangles), 2 * levels);
    return std::move(subdivision.pieces);
}

} // namespace kokage
