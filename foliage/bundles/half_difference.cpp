#include "foliage/bundles/half_difference.h"

#include "foliage/accuracy.h"

#include <algorithm>
#include <cmath>

namespace kokage::bundles {
namespace {

std::vector<glm::vec3> leaf_sides(const PatchScene& scene, const std::vector<Rgb>& sides) {
    SideRadiance radiance;
    radiance.front.resize(scene.patches.size());
    radiance.back.resize(scene.patches.size());
    for (std::size_t p = 0; p < scene.patches.size(); ++p) {
        radiance.front[p] = sides[2 * p].vec();
        radiance.back[p] = sides[2 * p + 1].vec();
    }
    return leaf_side_radiance(scene, radiance);
}

} // namespace

double half_difference_error(const PatchScene& scene, const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
    const std::vector<glm::vec3> first = leaf_sides(scene, a), second = leaf_sides(scene, b);
    if (first.empty())
        return 0;
    glm::dvec3 mean(0.0), error(0.0);
    for (std::size_t i = 0; i < first.size(); ++i)
        mean += 0.5 * (glm::dvec3(first[i]) + glm::dvec3(second[i])) / double(first.size());
    for (std::size_t i = 0; i < first.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const double value = 0.5 * (double(first[i][c]) + second[i][c]), floor = std::max(value, 0.05 * mean[c]);
            if (floor > 0)
                error[c] += 0.5 * std::abs(double(first[i][c]) - second[i][c]) / floor;
        }
    return (error.x + error.y + error.z) / (3 * double(first.size()));
}

} // namespace kokage::bundles
