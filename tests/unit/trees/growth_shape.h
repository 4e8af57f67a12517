#pragma once
// What the tests of growth measure on trees.
#include "trees/tree.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace kokage {

inline double triangle_area(const TreePart& part, const glm::uvec3& t) {
    const glm::dvec3 a(part.positions[t.x]), b(part.positions[t.y]), c(part.positions[t.z]);
    return 0.5 * glm::length(glm::cross(b - a, c - a));
}

/// Largest over smallest scale of the texture on a triangle.
inline double texture_stretch(const TreePart& part, const glm::uvec3& t) {
    const glm::dvec3 e1(part.positions[t.y] - part.positions[t.x]), e2(part.positions[t.z] - part.positions[t.x]);
    const glm::dvec2 w1(part.uvs[t.y] - part.uvs[t.x]), w2(part.uvs[t.z] - part.uvs[t.x]);
    const double det = w1.x * w2.y - w2.x * w1.y;
    if (det == 0)
        return 1e30;
    const glm::dvec3 du = (w2.y * e1 - w1.y * e2) / det, dv = (w1.x * e2 - w2.x * e1) / det;
    const double a = glm::dot(du, du), b = glm::dot(du, dv), c = glm::dot(dv, dv);
    const double root = std::sqrt((a - c) * (a - c) + 4 * b * b);
    return std::sqrt((a + c + root) / std::max(a + c - root, 1e-30));
}

inline bool is_finite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Throws nothing, returns true if all numbers are finite, all indices in range, all normals of unit length.
inline bool is_sound(const Tree& tree) {
    for (const TreePart& part : tree.parts) {
        if (part.normals.size() != part.positions.size() || part.uvs.size() != part.positions.size() ||
            part.triangle_patch.size() != part.triangles.size())
            return false;
        for (std::size_t i = 0; i < part.positions.size(); ++i)
            if (!is_finite(part.positions[i]) || std::abs(glm::length(part.normals[i]) - 1) > 1e-3f ||
                !std::isfinite(part.uvs[i].x) || !std::isfinite(part.uvs[i].y))
                return false;
        for (const glm::uvec3& t : part.triangles)
            if (std::max({t.x, t.y, t.z}) >= part.positions.size())
                return false;
    }
    for (const Leaf& leaf : tree.leaves)
        if (!is_finite(leaf.centre) || leaf.branch < 0 || std::size_t(leaf.branch) >= tree.skeleton.branches.size())
            return false;
    for (const Branch& branch : tree.skeleton.branches)
        for (const Branch::Node& node : branch.nodes)
            if (!is_finite(node.position) || !(node.radius_m > 0))
                return false;
    return true;
}

/// The bark of all zones as one part.
inline TreePart all_bark(const Tree& tree) {
    TreePart bark;
    for (const TreePart& part : tree.parts) {
        if (part.kind != TreePartKind::bark)
            continue;
        const std::uint32_t first = std::uint32_t(bark.positions.size());
        bark.positions.insert(bark.positions.end(), part.positions.begin(), part.positions.end());
        bark.normals.insert(bark.normals.end(), part.normals.begin(), part.normals.end());
        bark.uvs.insert(bark.uvs.end(), part.uvs.begin(), part.uvs.end());
        for (const glm::uvec3& t : part.triangles)
            bark.triangles.push_back(t + glm::uvec3(first));
        bark.triangle_patch.insert(bark.triangle_patch.end(), part.triangle_patch.begin(), part.triangle_patch.end());
    }
    return bark;
}

/// The crown as foresters measure it: its reach in 16 directions, height, and where leaves begin.
struct CrownShape {
    double projection = 0, width = 0, height = 0, lowest_leaf = 1e30, leaf_area = 0, mean_inclination_degrees = 0,
           widest_height = 0;
};

inline CrownShape measure_crown(const Tree& tree) {
    CrownShape shape;
    std::array<double, 16> reach{};
    std::array<double, 20> reach_at_height{};
    const TreePart& foliage = tree.parts[1];
    for (const glm::vec3& p : foliage.positions) {
        shape.height = std::max(shape.height, double(p.y));
        shape.lowest_leaf = std::min(shape.lowest_leaf, double(p.y));
        const double sector = (std::atan2(p.z, p.x) + kPiDouble) / (2 * kPiDouble) * 16;
        double& r = reach[std::size_t(sector) % 16];
        r = std::max(r, double(std::hypot(p.x, p.z)));
    }
    for (const glm::vec3& p : foliage.positions) {
        double& r = reach_at_height[std::min<std::size_t>(19, std::size_t(20 * p.y / shape.height))];
        r = std::max(r, double(std::hypot(p.x, p.z)));
    }
    shape.widest_height =
        (double(std::max_element(reach_at_height.begin(), reach_at_height.end()) - reach_at_height.begin()) + 0.5) / 20;
    for (const double r : reach)
        shape.projection += r * r * kPiDouble / 16;
    shape.width = 2 * std::sqrt(shape.projection / kPiDouble);
    for (const glm::uvec3& t : foliage.triangles) {
        const glm::dvec3 a(foliage.positions[t.x]), b(foliage.positions[t.y]), c(foliage.positions[t.z]);
        const glm::dvec3 normal = 0.5 * glm::cross(b - a, c - a);
        const double area = glm::length(normal);
        shape.leaf_area += area;
        shape.mean_inclination_degrees += area * std::acos(std::min(1.0, std::abs(normal.y) / area)) * 180 / kPiDouble;
    }
    shape.mean_inclination_degrees /= shape.leaf_area;
    return shape;
}

} // namespace kokage
