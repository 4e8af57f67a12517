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

} // namespace

LightSampler::LightSampler(const Environment& environment) {
    for (const DistantLight& light : environment.distant_lights)
        if (!black(light.irradiance)) {
            const float half = std::clamp(light.half_angle, 0.f, kPi / 2);
            distant_.push_back({light.direction, light.irradiance, std::cos(half), std::sin(half), &light, {}});
            double total = 0;
            for (const DistantLight::Texel& texel : light.texels)
                distant_.back().texel_shares.push_back(total += luminance(texel.irradiance));
            for (double& share : distant_.back().texel_shares)
                share /= total;
        }
    for (const PointLight& light : environment.point_lights)
        if (!black(light.intensity))
            points_.push_back({light.position, glm::dvec3(light.intensity)});
}

/// As sample_light() does, but in logarithmic time for regions of thousands of texels.
LightSample LightSampler::sample_distant(const Distant& distant, glm::vec2 numbers) {
    const std::vector<double>& shares = distant.texel_shares;
    if (shares.empty() || !(shares.back() > 0))
        return sample_light(*distant.light, numbers.x, numbers.y);
    const auto place = std::upper_bound(shares.begin(), shares.end() - 1, double(numbers.x));
    const double low = place == shares.begin() ? 0.0 : place[-1], share = *place - low;
    const DistantLight::Texel& texel = distant.light->texels[std::size_t(place - shares.begin())];
    if (!(share > 0)) // only where rounding has eaten the last texels
        return {texel.direction, glm::vec3(0)};
    const float rest = std::clamp(float((double(numbers.x) - low) / share), 0.f, 0x1.fffffep-1f);
    return {sample_cone(texel.direction, texel.half_angle, rest, numbers.y),
            glm::vec3(glm::dvec3(texel.irradiance) / share)};
}

/// The most that a light can bring if nothing shadows it. A sum of channels: every channel's own error counts alike, so
/// that blue must not be starved.
float LightSampler::bound(const Distant& light, const glm::vec3& normal, const glm::vec3& front,
                          const glm::vec3& back) {
    const float cosine = glm::dot(normal, light.direction);
    return largest_cosine(cosine, light.cos_half, light.sin_half) * glm::dot(front, light.irradiance) +
           largest_cosine(-cosine, light.cos_half, light.sin_half) * glm::dot(back, light.irradiance);
}

/// Under a sun alone there is nothing to choose.
std::optional<LightRay> LightSampler::only_light(const glm::vec3& normal, const glm::vec3& front, const glm::vec3& back,
                                                 glm::vec2 numbers) const {
    if (!(bound(distant_[0], normal, front, back) > 0))
        return std::nullopt;
    const LightSample drawn = sample_distant(distant_[0], numbers);
    return LightRay{drawn.direction, INFINITY, drawn.irradiance_over_pdf, distant_[0].light};
}

std::optional<LightRay> LightSampler::sample(const glm::vec3& point, const glm::vec3& normal, const glm::vec3& front,
                                             const glm::vec3& back, float choice, glm::vec2 numbers) const {
    if (distant_.size() == 1 && points_.empty())
        return only_light(normal, front, back, numbers);
    thread_local std::vector<double> cumulative; // scratch of one call
    cumulative.clear();
    double total = 0;
    for (const Distant& light : distant_) {
        total += double(bound(light, normal, front, back));
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
        const LightSample drawn = sample_distant(distant_[index], numbers);
        return LightRay{drawn.direction, INFINITY, drawn.irradiance_over_pdf / float(probability),
                        distant_[index].light};
    }
    const Point& light = points_[index - distant_.size()];
    const glm::dvec3 way(light.position - point);
    const double distance = glm::length(way);
    return LightRay{glm::vec3(way / distance), float(distance),
                    glm::vec3(light.intensity / (distance * distance * probability)), nullptr};
}

} // namespace kokage
