#include "foliage/accuracy.h"
#include "common/services/error.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace kokage {
namespace {

void require_equal(std::size_t count, std::size_t expected, const char* what) {
    if (count != expected)
        throw InputError(std::string("accuracy: ") + what + " holds " + std::to_string(count) + " values where " +
                         std::to_string(expected) + " are needed");
}

} // namespace

std::vector<glm::vec3> leaf_side_radiance(const PatchScene& scene, const SideRadiance& radiance) {
    require_equal(radiance.front.size(), scene.patches.size(), "the front's radiance");
    require_equal(radiance.back.size(), scene.patches.size(), "the back's radiance");
    const std::vector<double> areas = solid_areas(scene);
    std::vector<glm::dvec3> sum(2 * std::size_t(scene.leaf_count), glm::dvec3(0)), plain = sum;
    std::vector<double> area(scene.leaf_count, 0.0);
    std::vector<std::uint32_t> count(scene.leaf_count, 0);
    for (std::size_t p = 0; p < scene.patches.size(); ++p) {
        const Patch& patch = scene.patches[p];
        if (patch.kind != PatchKind::leaf)
            continue;
        const std::size_t front = 2 * std::size_t(patch.leaf);
        sum[front] += areas[p] * glm::dvec3(radiance.front[p]);
        sum[front + 1] += areas[p] * glm::dvec3(radiance.back[p]);
        plain[front] += glm::dvec3(radiance.front[p]);
        plain[front + 1] += glm::dvec3(radiance.back[p]);
        area[patch.leaf] += areas[p];
        ++count[patch.leaf];
    }
    std::vector<glm::vec3> sides(sum.size(), glm::vec3(0));
    for (std::size_t s = 0; s < sides.size(); ++s) {
        if (area[s / 2] > 0)
            sides[s] = glm::vec3(sum[s] / area[s / 2]);
        else if (count[s / 2] > 0) // a leaf without area: nothing to weight by
            sides[s] = glm::vec3(plain[s] / double(count[s / 2]));
    }
    return sides;
}

Accuracy accuracy(const std::vector<glm::vec3>& sides, const std::vector<glm::vec3>& reference,
                  const std::vector<double>& leaf_areas) {
    require_equal(sides.size(), reference.size(), "the shading");
    require_equal(2 * leaf_areas.size(), reference.size(), "twice the list of leaf areas");
    Accuracy result;
    if (sides.empty())
        return result;
    glm::dvec3 mean(0);
    for (const glm::vec3& side : reference)
        mean += glm::dvec3(side);
    mean /= double(reference.size());

    const glm::dvec3 floor = 0.05 * mean;
    std::vector<double> errors;
    errors.reserve(3 * sides.size());
    double squares = 0, difference = 0, total = 0, sum = 0;
    for (std::size_t s = 0; s < sides.size(); ++s)
        for (std::size_t c = 0; c < 3; ++c) {
            const double ref = reference[s][c], off = double(sides[s][c]) - ref, scale = std::max(ref, floor[c]);
            // A channel that is black throughout has no scale: wrong counts as 100 %, right as 0.
            errors.push_back(scale > 0 ? std::abs(off) / scale : (off != 0 ? 1.0 : 0.0));
            sum += errors.back();
            squares += off * off;
            difference += leaf_areas[s / 2] * off;
            total += leaf_areas[s / 2] * ref;
        }
    const double count = double(errors.size()), overall = (mean.x + mean.y + mean.z) / 3;
    result.mre = sum / count;
    result.rmse_over_mean = overall > 0 ? std::sqrt(squares / count) / overall : (squares > 0 ? 1.0 : 0.0);
    result.bias = total > 0 ? difference / total : (difference != 0 ? 1.0 : 0.0);
    // The smallest error that at least 95 % of all do not exceed.
    const std::size_t rank = std::min(errors.size() - 1, std::size_t(std::ceil(0.95 * count)) - 1);
    std::nth_element(errors.begin(), errors.begin() + std::ptrdiff_t(rank), errors.end());
    result.p95 = errors[rank];
    return result;
}

} // namespace kokage
