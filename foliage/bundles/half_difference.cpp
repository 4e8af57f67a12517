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

namespace {

/// MRE as in foliage/accuracy.h: mean over sides and channels of |difference| / max(value, 0.05 mean value of that
/// channel).
template <class Values>
double mean_relative(const Values& value, const Values& difference, std::size_t count) {
    if (count == 0)
        return 0;
    glm::dvec3 average(0.0), error(0.0);
    for (std::size_t i = 0; i < count; ++i)
        average += glm::dvec3(value(i));
    const glm::vec3 least(0.05 / double(count) * average);
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 floor = glm::max(value(i), least), step = glm::abs(difference(i));
        for (glm::length_t c = 0; c < 3; ++c)
            error[c] += floor[c] > 0 ? double(step[c] / floor[c]) : 0.0;
    }
    return (error.x + error.y + error.z) / (3 * double(count));
}

/// Every leaf is one patch, and leaves come first.
bool leaves_are_patches(const PatchScene& scene) {
    for (std::uint32_t p = 0; p < scene.leaf_count; ++p)
        if (p >= scene.patches.size() || scene.patches[p].kind != PatchKind::leaf || scene.patches[p].leaf != p)
            return false;
    return scene.leaf_count == scene.patches.size() || scene.patches[scene.leaf_count].kind == PatchKind::bark;
}

} // namespace

double half_difference_error(const PatchScene& scene, const std::vector<Rgb>& mean,
                             const std::vector<Rgb>& half_differences) {
    if (leaves_are_patches(scene)) {
        struct Sides {
            const std::vector<Rgb>& values;
            glm::vec3 operator()(std::size_t i) const { return values[i].vec(); }
        };
        return mean_relative(Sides{mean}, Sides{half_differences}, 2 * std::size_t(scene.leaf_count));
    }
    struct Sides {
        std::vector<glm::vec3> values;
        glm::vec3 operator()(std::size_t i) const { return values[i]; }
    };
    const Sides value{leaf_sides(scene, mean)}, difference{leaf_sides(scene, half_differences)};
    return mean_relative(value, difference, value.values.size());
}

} // namespace kokage::bundles
