#include "foliage/bundles/half_difference.h"

#include "foliage/accuracy.h"

#include <algorithm>
#include <cmath>

namespace kokage::bundles {

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

double half_difference_error(const PatchScene& scene, const std::vector<Rgb>& mean,
                             const std::vector<Rgb>& half_differences) {
    const std::vector<glm::vec3> value = leaf_sides(scene, mean), difference = leaf_sides(scene, half_differences);
    if (value.empty())
        return 0;
    glm::dvec3 average(0.0), error(0.0);
    for (const glm::vec3& side : value)
        average += glm::dvec3(side) / double(value.size());
    for (std::size_t i = 0; i < value.size(); ++i)
        for (int c = 0; c < 3; ++c)
            if (const double floor = std::max(double(value[i][c]), 0.05 * average[c]); floor > 0)
                error[c] += std::abs(double(difference[i][c])) / floor;
    return (error.x + error.y + error.z) / (3 * double(value.size()));
}

} // namespace kokage::bundles
