#include "trees/growth/leaves.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace kokage {
namespace {

/// Half-width of an oak leaf along its length: an obovate blade with three round lobes a side and one at the tip, and
/// narrow bays that reach almost halfway to the midrib.
float half_width(float y) {
    const float blade = 0.5f * std::pow(std::sin(kPi * std::pow(y, 1.35f)), 0.7f); // widest at y = 0.6
    const float lobes = std::abs(std::cos(4 * kPi * y));                           // 1 at y = 1/4, 1/2, 3/4, 1
    return blade * (0.56f + 0.44f * std::pow(lobes, 0.8f));
}

/// Mirrors the right side (x > 0, from base to tip) and triangulates each side by itself, in a strip from base to tip.
LeafShape from_right_side(const std::vector<glm::vec2>& right, const std::vector<std::array<int, 3>>& half_triangles) {
    // Vertices: base, right side upwards, tip, left side downwards.
    LeafShape shape;
    shape.outline.push_back({0, 0});
    shape.outline.insert(shape.outline.end(), right.begin(), right.end());
    shape.outline.push_back({0, 1});
    for (std::size_t i = right.size(); i-- > 0;)
        shape.outline.push_back({-right[i].x, right[i].y});
    const std::uint32_t tip = std::uint32_t(right.size()) + 1, count = std::uint32_t(shape.outline.size());
    const auto mirrored = [&](int i) {
        return i == 0 || std::uint32_t(i) == tip ? std::uint32_t(i) : count - std::uint32_t(i);
    };
    for (const auto& t : half_triangles)
        shape.triangles.push_back({std::uint32_t(t[0]), std::uint32_t(t[1]), std::uint32_t(t[2])});
    for (std::size_t i = half_triangles.size(); i-- > 0;) {
        const auto& t = half_triangles[i];
        shape.triangles.push_back({mirrored(t[0]), mirrored(t[2]), mirrored(t[1])});
    }
    return shape;
}

/// Round lobes: rows of three vertices (left edge, midrib, right edge) at the lobes and at the bays between them.
LeafShape fine_shape() {
    // Two rows on every lobe, one in every bay.
    const std::array<float, 11> heights = {0.125f, 0.21f, 0.29f, 0.375f, 0.46f, 0.54f,
                                           0.625f, 0.71f, 0.79f, 0.875f, 0.94f};
    LeafShape shape;
    shape.outline = {{0, 0}, {0, 1}}; // base 0, tip 1
    for (const float y : heights) {
        shape.outline.push_back({-half_width(y), y});
        shape.outline.push_back({0, y});
        shape.outline.push_back({half_width(y), y});
    }
    const auto vertex = [](std::uint32_t row, std::uint32_t column) { return 2 + 3 * row + column; };
    const std::uint32_t last = std::uint32_t(heights.size()) - 1;
    shape.triangles.push_back({0, vertex(0, 1), vertex(0, 0)});
    shape.triangles.push_back({0, vertex(0, 2), vertex(0, 1)});
    for (std::uint32_t row = 0; row < last; ++row)
        for (std::uint32_t column = 0; column < 2; ++column) {
            shape.triangles.push_back({vertex(row, column), vertex(row, column + 1), vertex(row + 1, column + 1)});
            shape.triangles.push_back({vertex(row, column), vertex(row + 1, column + 1), vertex(row + 1, column)});
        }
    shape.triangles.push_back({vertex(last, 0), vertex(last, 1), 1});
    shape.triangles.push_back({vertex(last, 1), vertex(last, 2), 1});
    return shape;
}

} // namespace

const LeafShape& leaf_shape(int detail) {
    static const LeafShape kite = from_right_side({{0.5f, 0.6f}}, {{0, 1, 2}});
    // Base 0, lower lobe 1, bay 2, widest lobe 3, shoulder 4, tip 5.
    static const LeafShape lobed = from_right_side({{0.34f, 0.36f}, {0.25f, 0.50f}, {0.5f, 0.70f}, {0.34f, 0.91f}},
                                                   {{0, 1, 2}, {0, 2, 5}, {2, 3, 4}, {2, 4, 5}});
    static const LeafShape fine = fine_shape();
    return detail <= 0 ? kite : detail == 1 ? lobed : fine;
}

double leaf_shape_area(int detail) {
    const LeafShape& shape = leaf_shape(detail);
    double area = 0;
    for (const glm::uvec3& t : shape.triangles) {
        const glm::dvec2 a(shape.outline[t.x]), b(shape.outline[t.y]), c(shape.outline[t.z]);
        area += 0.5 * std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
    }
    return area;
}

double leaf_mask_area() {
    constexpr int rows = 512;
    double area = 0;
    for (int i = 0; i < rows; ++i)
        area += 2.0 * half_width((float(i) + 0.5f) / rows) / rows;
    return area;
}

bool inside_leaf_shape(glm::vec2 uv) {
    const float y = 1 - uv.y;
    return y > 0 && y < 1 && std::abs(uv.x - 0.5f) < std::max(half_width(y), y < 0.2f ? 0.012f : 0.f);
}

} // namespace kokage
