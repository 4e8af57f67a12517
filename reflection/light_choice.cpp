#include "reflection/light_choice.h"
#include "reflection/sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kokage {
namespace {

constexpr std::size_t kFewLights = 2;
/// Keeps the inverse square finite where a point light touches a surface.
constexpr float kLeastSquaredDistance = 1e-20f;

float largest(const glm::vec3& rgb) {
    return std::max({rgb.r, rgb.g, rgb.b});
}

} // namespace

LightChoice::LightChoice(const Environment& environment, int light_samples)
    : environment_(environment), light_samples_(std::uint32_t(std::max(1, light_samples))),
      light_count_(environment.distant_lights.size() + environment.point_lights.size()) {
    for (const DistantLight& light : environment.distant_lights)
        sine_of_half_angle_.push_back(std::sin(std::min(light.half_angle, kPi / 2)));
}

float LightChoice::contribution(std::size_t light, const glm::vec3& point, const Scattering& scattering) const {
    if (light < environment_.distant_lights.size()) {
        const DistantLight& distant = environment_.distant_lights[light];
        // A wide light can reach over the horizon of its mean direction: its probability must not be 0 there.
        const glm::vec3 spill = sine_of_half_angle_[light] * (scattering.reflectance + scattering.transmittance) / kPi;
        return largest(distant.irradiance * (scattering.towards(distant.direction) + spill));
    }
    const PointLight& lamp = environment_.point_lights[light - environment_.distant_lights.size()];
    const glm::vec3 offset = lamp.position - point;
    const float squared = std::max(glm::dot(offset, offset), kLeastSquaredDistance);
    return largest(lamp.intensity / squared * scattering.towards(offset / std::sqrt(squared)));
}

void LightChoice::add_ray(std::size_t light, const glm::vec3& point, const Scattering& scattering, float weight,
                          glm::vec2 u, std::vector<LightRay>& rays) const {
    LightRay ray;
    if (light < environment_.distant_lights.size()) {
        const LightSample sample = sample_light(environment_.distant_lights[light], u.x, u.y);
        ray = {sample.direction, std::numeric_limits<float>::infinity(),
               weight * sample.irradiance_over_pdf * scattering.towards(sample.direction)};
    } else {
        const PointLight& lamp = environment_.point_lights[light - environment_.distant_lights.size()];
        const glm::vec3 offset = lamp.position - point;
        const float squared = std::max(glm::dot(offset, offset), kLeastSquaredDistance), distance = std::sqrt(squared);
        ray = {offset / distance, distance, weight * lamp.intensity / squared * scattering.towards(offset / distance)};
    }
    if (largest(ray.radiance) > 0)
        rays.push_back(ray);
}

void LightChoice::rays_at(const glm::vec3& point, const Scattering& scattering, SampleIndex sample,
                          std::vector<LightRay>& rays, std::vector<float>& scratch) const {
    rays.clear();
    if (light_count_ == 0 || largest(scattering.reflectance + scattering.transmittance) <= 0)
        return;
    const std::uint32_t count = sample.count * light_samples_;
    if (light_count_ <= kFewLights) {
        for (std::size_t light = 0; light < light_count_; ++light)
            for (std::uint32_t k = 0; k < light_samples_; ++k)
                add_ray(light, point, scattering, 1.f / float(light_samples_),
                        multi_jittered(sample.index * light_samples_ + k, count, sample.pattern + std::uint32_t(light)),
                        rays);
        return;
    }
    scratch.resize(light_count_);
    double total = 0;
    for (std::size_t light = 0; light < light_count_; ++light)
        total += scratch[light] = std::min(contribution(light, point, scattering), 1e30f);
    if (total <= 0)
        return;
    // Systematic sampling: one random start, then equal steps through the running sum. A light with the share p of the
    // sum is chosen floor(p picks) or ceil(p picks) times, and each choice weighs 1 / (picks p).
    const std::uint32_t picks = 2 * light_samples_;
    const double start = stratified(sample.index, sample.count, sample.pattern ^ 0x5bd1e995u), step = total / picks;
    double sum = 0;
    std::uint32_t pick = 0;
    for (std::size_t light = 0; light < light_count_ && pick < picks; ++light) {
        sum += scratch[light];
        while (pick < picks && (start + pick) * step < sum) {
            add_ray(light, point, scattering, float(step / double(scratch[light])),
                    multi_jittered(sample.index * picks + pick, sample.count * picks, sample.pattern + 1), rays);
            ++pick;
        }
    }
}

} // namespace kokage
