#include "common/trace/light_sampler.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

bool black(const glm::vec3& colour) {
    return !(colour.r > 0 || colour.g > 0 || colour.b > 0);
}

/// Largest cosine within a cone of directions around one whose own cosine is given; 0 if all of the cone is below the
/// horizon.
float largest_cosine(float cosine, float cos_half, float sin_half) {
    if (cosine >= cos_half)
        return 1;
    const float sine = std::sqrt(std::max(0.f, 1 - cosine * cosine));
    return std::max(0.f, cosine * cos_half + sine * sin_half);
}

/// Two vectors that make a right-handed frame with a unit vector (Duff et al. 2017).
void frame_of(const glm::vec3& n, glm::vec3& tangent, glm::vec3& bitangent) {
    const float sign = std::copysign(1.f, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
    tangent = {1 + sign * n.x * n.x * a, sign * b, -sign * n.x};
    bitangent = {b, sign + n.y * n.y * a, -n.y};
}

LightSample draw(const DistantLight& light, float u0, float u1) {
    if (!light.texels.empty() || light.half_angle <= 0)
        return {light.direction, light.irradiance};
    const float spread = 2 * std::pow(std::sin(light.half_angle / 2), 2.f); // 1 - cosine, without cancellation
    const float drop = u0 * spread, cosine = 1 - drop, sine = std::sqrt(drop * (2 - drop)), azimuth = 2 * kPi * u1;
    glm::vec3 tangent, bitangent;
    frame_of(light.direction, tangent, bitangent);
    return {sine * std::cos(azimuth) * tangent + sine * std::sin(azimuth) * bitangent + cosine * light.direction,
            light.irradiance * (2 / (2 - spread))};
}

} // namespace

LightSampler::LightSampler(const Environment& environment) {
    for (const DistantLight& light : environment.distant_lights)
        if (!black(light.irradiance)) {
            const float half = std::clamp(light.half_angle, 0.f, kPi / 2);
            distant_.push_back({light.direction, light.irradiance, std::cos(half), std::sin(half), &light});
        }
    for (const PointLight& light : environment.point_lights)
        if (!black(light.intensity))
            points_.push_back({light.position, glm::dvec3(light.intensity)});
}

std::optional<LightRay> LightSampler::sample(const glm::vec3& point, const glm::vec3& normal, const glm::vec3& front,
                                             const glm::vec3& back, float choice, glm::vec2 numbers) const {
    thread_local std::vector<double> cumulative; // scratch of one call
    cumulative.clear();
    double total = 0;
    for (const Distant& light : distant_) {
        const float cosine = glm::dot(normal, light.direction);
        // Sums of channels: every channel's own error counts alike, so that blue must not be starved.
        total += double(largest_cosine(cosine, light.cos_half, light.sin_half)) * glm::dot(front, light.irradiance) +
                 double(largest_cosine(-cosine, light.cos_half, light.sin_half)) * glm::dot(back, light.irradiance);
        cumulative.push_back(total);
    }
    for (const Point& light : points_) {
        const glm::dvec3 way(light.position - point);
        const double squared = glm::dot(way, way), cosine = glm::dot(glm::dvec3(normal), way) / std::sqrt(squared);
        if (squared > 0)
            total += std::abs(cosine) * glm::dot(glm::dvec3(cosine > 0 ? front : back), light.intensity) / squared;
        cumulative.push_back(total);
    }
    if (!(total > 0) || !std::isfinite(total))
        return std::nullopt;

    const auto place = std::upper_bound(cumulative.begin(), cumulative.end() - 1, double(choice) * total);
    const std::size_t index = std::size_t(place - cumulative.begin());
    const double probability = (cumulative[index] - (index > 0 ? cumulative[index - 1] : 0.0)) / total;
    if (!(probability > 0))
        return std::nullopt;
    if (index < distant_.size()) {
        const LightSample drawn = draw(*distant_[index].light, numbers.x, numbers.y);
        return LightRay{drawn.direction, INFINITY, drawn.irradiance_over_pdf / float(probability)};
    }
    const Point& light = points_[index - distant_.size()];
    const glm::dvec3 way(light.position - point);
    const double distance = glm::length(way);
    return LightRay{glm::vec3(way / distance), float(distance),
                    glm::vec3(light.intensity / (distance * distance * probability))};
}

} // namespace kokage
