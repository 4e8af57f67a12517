#include "reflection/maps/light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace kokage {
namespace {

constexpr std::uint32_t kLeaf = 4; ///< points that are not divided further

float largest(const glm::vec3& v) {
    return std::max({v.r, v.g, v.b});
}

} // namespace

/// Phong, with c = 1 - d²/2: f = c^Λ, |f'| = Λ d c^(Λ-1), |f''| <= Λ c^(Λ-1) + Λ² d² c^(Λ-2); over all d these are
/// below sqrt(Λ) and 2 Λ, from Λ = 2 on. Lobes that are wider end with a steep edge at the horizon and have no bounds.
/// GGX, with F = falloff/2: f = (1 - d²/2) g, g = 1 / (1 + F d²)², where |g'| <= 4 F d / (1 + F d²) g (at most 2
/// sqrt(F) g) and |g''| <= 24 F / (1 + F d²) g fall with d, the former from F d² = 1 on; the factor in front has slope
/// d <= sqrt(2) and curvature 1. What falls is taken where the distance begins, by the steepest lobe, times the widest
/// lobe's value.
LobeBounds::Change LobeBounds::from(float distance) const {
    const float d2 = distance * distance;
    if (d2 >= 2)
        return {0, 0, 0};
    if (kind == LobeKind::phong) {
        if (widest < 2)
            return {peak, HUGE_VALF, HUGE_VALF};
        const float steep = steepest, log_c = std::log1p(-0.5f * d2);
        const float value = std::exp(widest * log_c), tail = std::exp((widest - 2) * log_c);
        return {peak * value, peak * std::min(2 * std::sqrt(steep), 1.5f * steep * tail),
                peak * std::min(2 * steep, (steep + 2 * steep * steep) * tail)};
    }
    const float wide = 1 / (1 + 0.5f * widest * d2), value = peak * wide * wide;
    const float f = 0.5f * steepest, fall = 1 + f * d2;
    const float slope = f * d2 > 1 ? 4 * f * distance / fall : 2 * std::sqrt(f);
    return {value, value * (slope + 1.42f), value * (24 * f / fall + 2.84f * slope + 1)};
}

LightTree::LightTree(const ClusterOfLight& cluster) : points_(cluster.points) {
    if (points_.empty())
        return;
    nodes_.reserve(points_.size());
    add_node(0, std::uint32_t(points_.size()));
}

std::uint32_t LightTree::add_node(std::uint32_t begin, std::uint32_t end) {
    glm::dvec3 irradiance(0), middle(0);
    glm::vec3 least(2.f), most(-2.f);
    for (std::uint32_t i = begin; i < end; ++i) {
        const PointOfLight& p = points_[i];
        irradiance += glm::dvec3(p.irradiance);
        middle += double(p.irradiance.r + p.irradiance.g + p.irradiance.b) * glm::dvec3(p.direction);
        least = glm::min(least, p.direction);
        most = glm::max(most, p.direction);
    }
    Node node;
    node.begin = begin;
    node.end = end;
    const double length = glm::length(middle);
    node.middle = {length > 0 ? glm::vec3(middle / length) : points_[begin].direction, glm::vec3(irradiance)};
    std::array<glm::vec3, 3> first{glm::vec3(0), glm::vec3(0), glm::vec3(0)};
    glm::vec3 second(0);
    for (std::uint32_t i = begin; i < end; ++i) {
        const glm::vec3 offset = points_[i].direction - node.middle.direction;
        const float squared = glm::dot(offset, offset);
        node.radius = std::max(node.radius, std::sqrt(squared));
        second += points_[i].irradiance * squared;
        for (glm::length_t c = 0; c < 3; ++c)
            first[std::size_t(c)] += points_[i].irradiance[c] * offset;
    }
    node.first = std::max({glm::length(first[0]), glm::length(first[1]), glm::length(first[2])});
    node.second = largest(second);
    const auto at = std::uint32_t(nodes_.size());
    nodes_.push_back(node);
    if (end - begin > kLeaf) {
        const glm::vec3 size = most - least;
        const glm::length_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const std::uint32_t half = begin + (end - begin) / 2;
        std::nth_element(points_.begin() + begin, points_.begin() + half, points_.begin() + end,
                         [axis](const PointOfLight& a, const PointOfLight& b) {
                             return std::array{a.direction[axis], a.direction.x, a.direction.y, a.direction.z} <
                                    std::array{b.direction[axis], b.direction.x, b.direction.y, b.direction.z};
                         });
        add_node(begin, half);
        nodes_[at].other = add_node(half, end);
    }
    return at;
}

void LightTree::gather(const glm::vec3& axis, float chord, float reach, const LobeBounds& lobes, float error,
                       std::vector<PointOfLight>& points) const {
    std::array<std::uint32_t, 64> stack;
    std::size_t depth = 0;
    if (!nodes_.empty())
        stack[depth++] = 0;
    while (depth > 0) {
        const std::uint32_t at = stack[--depth];
        const Node& node = nodes_[at];
        const float apart = glm::distance(axis, node.middle.direction);
        if (apart > reach + node.radius)
            continue;
        const float nearest = std::max(apart - chord - node.radius, 0.f);
        const LobeBounds::Change change = lobes.from(nearest);
        const bool over_horizon = apart + chord + node.radius > 1.414f; // there the lobe's slope jumps to 0
        const float off = node.first * change.slope + 0.5f * node.second * change.curvature +
                          (over_horizon ? largest(node.middle.irradiance) * node.radius * change.slope : 0.f);
        if (off <= error) {
            points.push_back(node.middle);
        } else if (node.other == 0) {
            for (std::uint32_t i = node.begin; i < node.end; ++i)
                if (glm::distance(axis, points_[i].direction) <= reach)
                    points.push_back(points_[i]);
        } else {
            stack[depth++] = node.other;
            stack[depth++] = at + 1;
        }
    }
}

} // namespace kokage
