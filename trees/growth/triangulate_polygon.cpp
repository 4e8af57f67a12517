#include "trees/growth/triangulate_polygon.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace kokage {
namespace {

double twice_area(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Sine of the smallest angle (or of its supplement, which no smallest angle has): twice the area over the product of
/// the two longer sides.
double slenderness(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    double sides[3] = {glm::length(b - a), glm::length(c - b), glm::length(a - c)};
    std::sort(sides, sides + 3);
    const double product = sides[1] * sides[2];
    return product > 0 ? twice_area(a, b, c) / product : 0;
}

} // namespace

std::vector<glm::uvec3> triangulate_polygon(std::span<const glm::vec2> corners) {
    std::vector<std::uint32_t> left(corners.size());
    std::iota(left.begin(), left.end(), 0u);
    const auto at = [&](std::uint32_t i) { return glm::dvec2(corners[i]); };
    std::vector<glm::uvec3> triangles;
    while (left.size() > 3) {
        std::size_t best = left.size();
        double best_quality = 0;
        for (std::size_t k = 0; k < left.size(); ++k) {
            const std::uint32_t ia = left[(k + left.size() - 1) % left.size()], ib = left[k],
                                ic = left[(k + 1) % left.size()];
            const glm::dvec2 a = at(ia), b = at(ib), c = at(ic);
            if (twice_area(a, b, c) <= 0)
                continue;
            const bool is_ear = std::none_of(left.begin(), left.end(), [&](std::uint32_t i) {
                return i != ia && i != ib && i != ic && twice_area(a, b, at(i)) >= 0 && twice_area(b, c, at(i)) >= 0 &&
                       twice_area(c, a, at(i)) >= 0;
            });
            const double quality = slenderness(a, b, c);
            if (is_ear && quality > best_quality) {
                best = k;
                best_quality = quality;
            }
        }
        if (best == left.size())
            throw std::logic_error("a polygon that is not simple or not counter-clockwise can't be cut into triangles");
        triangles.push_back({left[(best + left.size() - 1) % left.size()], left[best], left[(best + 1) % left.size()]});
        left.erase(left.begin() + std::ptrdiff_t(best));
    }
    triangles.push_back({left[0], left[1], left[2]});
    return triangles;
}

} // namespace kokage
