#include "reflection/patch_gradients.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

constexpr double kPriorChange = 0.2; ///< standard deviation of light over a patch, over its mean
constexpr float kLeast = 0.4f, kMost = 2.f;

} // namespace

float PatchGradient::at(const glm::vec3& point) const {
    return std::clamp(1 + glm::dot(slope, point - centre), kLeast, kMost);
}

void PatchMoments::add(const glm::vec3& point, float light) {
    const glm::dvec3 p = glm::dvec3(point) - glm::dvec3(origin_);
    ++count_;
    points_ += p;
    products_ += glm::outerProduct(p, p);
    lights_ += double(light);
    squares_ += double(light) * double(light);
    lights_of_points_ += double(light) * p;
}

PatchGradient PatchMoments::gradient() const {
    PatchGradient result;
    if (!(count_ > 2) || !(lights_ > 0))
        return result;
    const glm::dvec3 centre = points_ / count_;
    const double mean = lights_ / count_, noise = squares_ / count_ / (mean * mean) - 1;
    glm::dmat3 spread = products_ - glm::outerProduct(points_, centre);
    const double extent = (spread[0][0] + spread[1][1] + spread[2][2]) / count_; // squared
    const double ridge = std::max(noise, 0.) / (kPriorChange * kPriorChange) * extent + 1e-6 * count_ * extent;
    if (!(ridge > 0) || !std::isfinite(ridge))
        return result;
    for (int k = 0; k < 3; ++k)
        spread[k][k] += ridge;
    const glm::dvec3 slope = glm::inverse(spread) * (lights_of_points_ - mean * points_) / mean;
    if (!std::isfinite(slope.x + slope.y + slope.z))
        return result;
    result.centre = glm::vec3(centre + glm::dvec3(origin_));
    result.slope = glm::vec3(slope);
    return result;
}

void PatchGradients::set(std::size_t places, std::uint32_t place, const PatchGradient& gradient) {
    if (gradients_.places() == 0)
        gradients_ = ValuesOfSome<PatchGradient>(places);
    gradients_.at(place) = gradient;
}

} // namespace kokage
