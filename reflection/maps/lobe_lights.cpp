#include "reflection/maps/lobe_lights.h"
#include "common/directions/legendre.h"
#include "common/services/parallel.h"
#include "reflection/maps/shell_map.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

constexpr std::size_t kGroup = 64;

float angle_between(const glm::vec3& a, const glm::vec3& b) {
    return 2 * std::asin(std::min(1.f, 0.5f * glm::distance(a, b)));
}

} // namespace

void append_points(const DistantLight& light, double least_spread, std::vector<PointOfLight>& points) {
    if (!light.texels.empty()) {
        for (const DistantLight::Texel& texel : light.texels)
            points.push_back({texel.direction, texel.irradiance});
        return;
    }
    if (!(light.half_angle > 0)) {
        points.push_back({glm::normalize(light.direction), light.irradiance});
        return;
    }
    const double half_angle = double(light.half_angle), half_sine = std::sin(0.5 * half_angle),
                 height = 2 * half_sine * half_sine; // 1 - cos
    // irradiance = radiance x pi sin^2; what lobes take is radiance x solid angle.
    const double ratio = half_angle <= kPiDouble / 2 ? 2 / (2 - height) : 2 * height;
    const int rings = std::clamp(2 + int(std::ceil(1.5 * half_angle / std::sqrt(least_spread))), 2, 64);
    const glm::dvec3 axis = glm::normalize(glm::dvec3(light.direction));
    const glm::dvec3 u =
        glm::normalize(glm::cross(axis, std::abs(axis.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0)));
    const glm::dvec3 v = glm::cross(axis, u);
    int ring = 0;
    for (const QuadratureNode& node : gauss_legendre(rings)) {
        const double w = 0.5 * (1 + node.x) * height, sine = std::sqrt(w * (2 - w));
        const int around = 4 * rings;
        for (int i = 0; i < around; ++i) {
            const double turn = 2 * kPiDouble * (i + 0.5 * (ring % 2)) / around;
            points.push_back({glm::vec3((1 - w) * axis + sine * (std::cos(turn) * u + std::sin(turn) * v)),
                              light.irradiance * float(0.5 * node.weight / around * ratio)});
        }
        ++ring;
    }
}

LobeLights::LobeLights(const TexelLayout& layout) : layout_(layout) {
    for (std::size_t begin = 0; begin < layout.size(); begin += kGroup) {
        const std::size_t end = std::min(begin + kGroup, layout.size());
        glm::vec3 sum(0);
        for (std::size_t i = begin; i < end; ++i)
            sum += layout.directions[i];
        const float length = glm::length(sum);
        Group group{std::uint32_t(begin), std::uint32_t(end), length > 0 ? sum / length : layout.directions[begin], 0,
                    layout.parameters[begin]};
        for (std::size_t i = begin; i < end; ++i) {
            group.half_angle = std::max(group.half_angle, angle_between(group.axis, layout.directions[i]));
            if (lobe_spread({layout.kind, double(layout.parameters[i])}) >
                lobe_spread({layout.kind, double(group.widest)}))
                group.widest = layout.parameters[i];
        }
        groups_.push_back(group);
    }
}

std::uint64_t LobeLights::add(std::span<const PointOfLight> points, float negligible, std::span<const float> factors,
                              std::span<glm::vec3> filtered) const {
    std::vector<std::uint64_t> evaluated(groups_.size());
    parallel_blocks(groups_.size(), 16, [&](std::size_t first, std::size_t last) {
        for (std::size_t g = first; g < last; ++g) {
            const Group& group = groups_[g];
            for (const PointOfLight& point : points) {
                const double brightest = double(std::max({point.irradiance.r, point.irradiance.g, point.irradiance.b}));
                const Lobe widest{layout_.kind, double(group.widest)};
                // A narrower lobe of the group may be higher, but where it reaches as far it is lower.
                const double share = double(negligible) / (brightest * lobe_value(widest, 0));
                if (!(share < 1e3))
                    continue;
                const double reach = lobe_reach(widest, std::min(share * 1e-3, 1.0));
                const double angle = 2 * std::asin(std::min(1.0, 0.5 * std::sqrt(reach)));
                if (double(angle_between(group.axis, point.direction)) > double(group.half_angle) + angle)
                    continue;
                evaluated[g] += group.end - group.begin;
                for (std::uint32_t i = group.begin; i < group.end; ++i) {
                    const glm::dvec3 between = glm::dvec3(layout_.directions[i]) - glm::dvec3(point.direction);
                    const Lobe lobe{layout_.kind, double(layout_.parameters[i])};
                    const float factor = factors.empty() ? 1.f : factors[i];
                    filtered[i] += factor * float(lobe_value(lobe, glm::dot(between, between))) * point.irradiance;
                }
            }
        }
    });
    std::uint64_t all = 0;
    for (const std::uint64_t count : evaluated)
        all += count;
    return all;
}

} // namespace kokage
