#include "trees/growth/sky_light.h"

#include "common/directions/sphere_sets.h"
#include "common/directions/spherical_harmonics.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

constexpr int cells_across = 12, direction_count = 64;
/// Share of its area that a leaf shows, seen from any side, when leaves face all ways.
constexpr float shown_share = 0.5f;

} // namespace

SkyLight::SkyLight(const std::vector<glm::vec3>& points, double leaf_area_m2, const Neighbours& neighbours) {
    glm::vec3 high = low_ = points.empty() ? glm::vec3(0.f) : points[0];
    for (const glm::vec3& p : points) {
        low_ = glm::min(low_, p);
        high = glm::max(high, p);
    }
    cell_ = std::max({high.x - low_.x, high.y - low_.y, high.z - low_.z, 1e-3f}) / float(cells_across);
    cells_ = glm::ivec3((high - low_) / cell_) + 1;
    const auto cell_index = [&](const glm::ivec3& c) { return std::size_t((c.z * cells_.y + c.y) * cells_.x + c.x); };
    std::vector<float> density(std::size_t(cells_.x) * std::size_t(cells_.y) * std::size_t(cells_.z), 0.f);
    const float share = points.empty() ? 0.f : float(leaf_area_m2 / double(points.size())) / (cell_ * cell_ * cell_);
    for (const glm::vec3& p : points)
        density[cell_index(glm::min(glm::ivec3((p - low_) / cell_), cells_ - 1))] += share;

    // The sky's half of an even set of directions.
    std::vector<glm::vec3> directions;
    std::vector<Coefficients> harmonics;
    for (const glm::dvec3& d : fibonacci_sphere(direction_count).directions)
        if (d.y > 0) {
            directions.emplace_back(d);
            harmonics.emplace_back();
            evaluate_sh(2, directions.back(), harmonics.back());
        }
    const float solid_angle = 2 * kPi / float(directions.size());
    const glm::ivec3 corners = cells_ + 1;
    corners_.assign(std::size_t(corners.x) * std::size_t(corners.y) * std::size_t(corners.z), Coefficients{});
    for (int z = 0; z < corners.z; ++z)
        for (int y = 0; y < corners.y; ++y)
            for (int x = 0; x < corners.x; ++x) {
                Coefficients& sum = corners_[std::size_t((z * corners.y + y) * corners.x + x)];
                for (std::size_t d = 0; d < directions.size(); ++d) {
                    // Steps of one cell, each read in its middle; the way out of the grid is at most its diagonal.
                    float depth = 0;
                    glm::vec3 place = glm::vec3(x, y, z) + 0.5f * directions[d];
                    for (; depth < 12; place += directions[d]) {
                        const glm::ivec3 c(glm::floor(place));
                        if (glm::any(glm::lessThan(c, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(c, cells_)))
                            break;
                        depth += shown_share * cell_ * density[cell_index(c)];
                    }
                    if (neighbours.leaf_area_density > 0) {
                        const float left_at = low_.y + cell_ * (place.y - 0.5f * directions[d].y);
                        const float up = std::max(0.f, neighbours.top_m - std::max(left_at, neighbours.base_m));
                        depth += shown_share * float(neighbours.leaf_area_density) * up / directions[d].y;
                    }
                    const float light = std::exp(-depth) * solid_angle;
                    for (std::size_t k = 0; k < 4; ++k)
                        sum[k] += light * harmonics[d][k];
                }
            }
}

SkyLight::Coefficients SkyLight::at(const glm::vec3& place) const {
    const glm::vec3 p = glm::clamp((place - low_) / cell_, glm::vec3(0.f), glm::vec3(cells_));
    const glm::ivec3 c = glm::min(glm::ivec3(p), cells_ - 1);
    const glm::vec3 t = p - glm::vec3(c);
    Coefficients result{};
    for (int k = 0; k < 8; ++k) {
        const glm::ivec3 o(k & 1, (k >> 1) & 1, k >> 2);
        const float weight = (o.x ? t.x : 1 - t.x) * (o.y ? t.y : 1 - t.y) * (o.z ? t.z : 1 - t.z);
        const glm::ivec3 corner = c + o;
        const Coefficients& there =
            corners_[std::size_t((corner.z * (cells_.y + 1) + corner.y) * (cells_.x + 1) + corner.x)];
        for (std::size_t i = 0; i < 4; ++i)
            result[i] += weight * there[i];
    }
    return result;
}

float SkyLight::relative(const glm::vec3& place) const {
    // Integral of the light over directions = coefficient 0 over Y_00 = 1/(2 sqrt pi); under the open sky it is 2 pi.
    return at(place)[0] * 2 * std::sqrt(kPi) / (2 * kPi);
}

glm::vec3 SkyLight::direction(const glm::vec3& place) const {
    // Integral of light x direction = coefficients 1..3 / sqrt(3/(4 pi)); over the integral of light.
    const Coefficients c = at(place);
    const float total = c[0] * 2 * std::sqrt(kPi);
    return total > 1e-9f ? glm::vec3(c[3], c[1], c[2]) * std::sqrt(4 * kPi / 3) / total : glm::vec3(0, 1, 0);
}

} // namespace kokage
