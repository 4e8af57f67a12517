#include "foliage/bundles/light_shares.h"

#include "common/environment/lat_long.h"

#include <algorithm>
#include <cmath>

namespace kokage::bundles {
namespace {

constexpr int kColumns = 8, kRows = 4; ///< cells
constexpr int kSamples = 4;            ///< of a cell, along either axis: the remainder is smooth

glm::vec3 cell_irradiance(const Image& remainder, int column, int row) {
    glm::vec3 sum(0.f);
    for (int y = row * kSamples; y < (row + 1) * kSamples; ++y) {
        const float solid_angle = float(pixel_solid_angle(y, kColumns * kSamples, kRows * kSamples));
        for (int x = column * kSamples; x < (column + 1) * kSamples; ++x) {
            const glm::vec3 direction(pixel_direction(x, y, kColumns * kSamples, kRows * kSamples));
            sum += solid_angle * lat_long_radiance(remainder, direction);
        }
    }
    return sum;
}

} // namespace

std::vector<glm::vec3> light_shares(const Environment& environment, const glm::vec3& centre, bool above_horizon) {
    std::vector<glm::vec3> shares;
    for (const DistantLight& light : environment.distant_lights)
        shares.push_back(light.irradiance);
    for (const PointLight& light : environment.point_lights) {
        const glm::vec3 off = light.position - centre;
        shares.push_back(light.intensity / std::max(glm::dot(off, off), 1e-6f));
    }
    for (int row = 0; row < (above_horizon ? kRows / 2 : kRows); ++row)
        for (int column = 0; column < kColumns; ++column)
            shares.push_back(cell_irradiance(environment.remainder, column, row));
    glm::dvec3 total(0.0);
    for (const glm::vec3& share : shares)
        total += glm::dvec3(share);
    for (glm::vec3& share : shares)
        for (std::size_t c = 0; c < 3; ++c)
            share[c] = total[c] > 0 ? float(double(share[c]) / total[c]) : 0.f;
    return shares;
}

double moved_light(const std::vector<glm::vec3>& before, const std::vector<glm::vec3>& now) {
    if (before.size() != now.size())
        return 1;
    glm::dvec3 sum(0.0);
    for (std::size_t i = 0; i < now.size(); ++i)
        sum += 0.5 * glm::abs(glm::dvec3(now[i]) - glm::dvec3(before[i]));
    return std::max({sum.x, sum.y, sum.z});
}

} // namespace kokage::bundles
