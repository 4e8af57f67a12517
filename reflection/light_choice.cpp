#include "reflection/light_choice.h"
#include "common/directions/lobes.h"
#include "reflection/glossy_light.h"
#include "reflection/sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kokage {
namespace {

/// So many are all tested. (Chosen by what they would contribute if nothing hid them, a strong light that is hidden
/// would take most rays.)
constexpr std::size_t kFewLights = 6;
/// Keeps the inverse square finite where a point light touches a surface.
constexpr float kLeastSquaredDistance = 1e-20f;

constexpr float kWide = 0.05f; ///< half angle; the sun's is 0.005
/// Rays that are shared out among more.
constexpr std::uint32_t kPicks = 2, kPicksAmongWide = 4;
/// Rays to a wide light, whose penumbra is wide: so many, and fewer where wide lights would take more than so many in
/// all.
constexpr std::size_t kMostOfWide = 4, kMostOfAllWide = 8;

/// Directions that are near one another mostly have near numbers.
std::uint32_t place_of(const glm::vec3& direction) {
    const glm::vec2 uv = glm::clamp(lat_long_from_direction(direction), 0.f, 1.f) * 65535.f;
    return place_on_curve(std::uint32_t(uv.x), std::uint32_t(uv.y));
}

float largest(const glm::vec3& rgb) {
    return std::max({rgb.r, rgb.g, rgb.b});
}

} // namespace

glm::vec3 Scattering::mirrored_towards(const glm::vec3& direction_to_light) const {
    if (!is_glossy() || glm::dot(normal, direction_to_light) <= 0)
        return glm::vec3(0.f);
    const glm::dvec3 apart = glm::dvec3(mirrored) - glm::dvec3(direction_to_light);
    return gloss * float(ggx_lobe_value(roughness, glm::dot(apart, apart)));
}

LightChoice::LightChoice(const Environment& environment, int light_samples)
    : points_(environment.point_lights), light_samples_(std::uint32_t(std::max(1, light_samples))) {
    const auto is_wide = [](const DistantLight& light) { return light.half_angle > kWide; };
    const auto& lights = environment.distant_lights;
    const auto wide = std::size_t(std::count_if(lights.begin(), lights.end(), is_wide));
    const std::size_t of_wide =
        std::clamp<std::size_t>(kMostOfAllWide / std::max<std::size_t>(wide, 1), 1, kMostOfWide);
    for (const DistantLight& light : lights)
        distant_.push_back(prepare(light, light_samples_ * std::uint32_t(is_wide(light) ? of_wide : 1)));
    picks_ = light_samples_ * (wide > 0 ? kPicksAmongWide : kPicks);
}

LightChoice::Distant LightChoice::prepare(const DistantLight& light, std::uint32_t rays) {
    Distant result{light,
                   Cone(light.direction, light.half_angle),
                   light.irradiance * radiance_over_density_of_disc(light.half_angle),
                   std::sin(std::min(light.half_angle, kPi / 2)),
                   rays,
                   {}};
    std::stable_sort(result.light.texels.begin(), result.light.texels.end(),
                     [](const auto& a, const auto& b) { return place_of(a.direction) < place_of(b.direction); });
    double total = 0;
    for (const DistantLight::Texel& texel : result.light.texels)
        result.shares.push_back(total += luminance(texel.irradiance));
    for (double& share : result.shares) // a region that is black throughout contributes nothing, whatever is drawn
        share = total > 0 ? share / total : 1;
    return result;
}

/// As sample_light() does, but in logarithmic time, and along the curve.
LightSample LightChoice::draw(const Distant& distant, glm::vec2 u) {
    if (distant.shares.empty())
        return {distant.cone.sample(u.x, u.y), distant.disc_irradiance};
    const auto found = std::upper_bound(distant.shares.begin(), distant.shares.end() - 1, double(u.x));
    const double before = found == distant.shares.begin() ? 0 : found[-1], share = *found - before;
    const DistantLight::Texel& texel = distant.light.texels[std::size_t(found - distant.shares.begin())];
    if (!(share > 0)) // only the last, where rounding has eaten it
        return {texel.direction, glm::vec3(0.f)};
    const float rest = std::clamp(float((double(u.x) - before) / share), 0.f, 0x1.fffffep-1f);
    return {sample_cone(texel.direction, texel.half_angle, rest, u.y), glm::vec3(glm::dvec3(texel.irradiance) / share)};
}

float LightChoice::contribution(std::size_t light, const glm::vec3& point, const Scattering& scattering) const {
    if (light < distant_.size()) {
        const Distant& distant = distant_[light];
        // A wide light can reach over the horizon of its mean direction: its probability must not be 0 there.
        const glm::vec3 spill =
            distant.sine_of_half_angle * (scattering.reflectance + scattering.transmittance + scattering.gloss) / kPi;
        return largest(distant.light.irradiance * (scattering.towards(distant.light.direction) +
                                                   scattering.mirrored_towards(distant.light.direction) + spill));
    }
    const PointLight& lamp = points_[light - distant_.size()];
    const glm::vec3 offset = lamp.position - point;
    const float squared = std::max(glm::dot(offset, offset), kLeastSquaredDistance);
    const glm::vec3 direction = offset / std::sqrt(squared);
    return largest(lamp.intensity / squared * (scattering.towards(direction) + scattering.mirrored_towards(direction)));
}

void LightChoice::add_ray(std::size_t light, const glm::vec3& point, const Scattering& scattering, float weight,
                          glm::vec2 u, std::vector<ShadowRay>& rays) const {
    ShadowRay ray;
    if (light < distant_.size()) {
        const LightSample sample = draw(distant_[light], u);
        ray = {sample.direction, std::numeric_limits<float>::infinity(),
               weight * sample.irradiance_over_pdf * scattering.towards(sample.direction)};
        if (scattering.is_glossy() &&
            (scattering.mirrors_wide_lights || !is_wide_for(distant_[light].light, scattering.roughness)))
            ray.reflection = weight * sample.irradiance_over_pdf * scattering.mirrored_towards(sample.direction);
    } else {
        const PointLight& lamp = points_[light - distant_.size()];
        const glm::vec3 offset = lamp.position - point;
        const float squared = std::max(glm::dot(offset, offset), kLeastSquaredDistance), distance = std::sqrt(squared);
        const glm::vec3 arrives = weight * lamp.intensity / squared;
        ray = {offset / distance, distance, arrives * scattering.towards(offset / distance),
               arrives * scattering.mirrored_towards(offset / distance)};
    }
    if (largest(ray.radiance) > 0 || largest(ray.reflection) > 0)
        rays.push_back(ray);
}

void LightChoice::rays_at(const glm::vec3& point, const Scattering& scattering, SampleIndex sample,
                          std::vector<ShadowRay>& rays, std::vector<float>& scratch) const {
    rays.clear();
    const std::size_t light_count = distant_.size() + points_.size();
    if (light_count == 0 || largest(scattering.reflectance + scattering.transmittance + scattering.gloss) <= 0)
        return;
    if (light_count <= kFewLights) {
        for (std::size_t light = 0; light < light_count; ++light) {
            const std::uint32_t count = light < distant_.size() ? distant_[light].rays : 1;
            for (std::uint32_t k = 0; k < count; ++k)
                add_ray(light, point, scattering, 1.f / float(count),
                        evenly_spread(sample.index * count + k, sample.pattern + std::uint32_t(light)), rays);
        }
        return;
    }
    scratch.resize(light_count);
    double total = 0;
    for (std::size_t light = 0; light < light_count; ++light)
        total += scratch[light] = std::min(contribution(light, point, scattering), 1e30f);
    if (total <= 0)
        return;
    // Systematic sampling: one random start, then equal steps through the running sum. A light with the share p of the
    // sum is chosen floor(p picks) or ceil(p picks) times, and each choice weighs 1 / (picks p).
    const std::uint32_t picks = picks_;
    const double start = stratified(sample.index, sample.count, sample.pattern ^ 0x5bd1e995u), step = total / picks;
    double sum = 0;
    std::uint32_t pick = 0;
    for (std::size_t light = 0; light < light_count && pick < picks; ++light) {
        // Where in a light's share a step falls is spread over the pixel's samples as evenly as the starts are: it
        // also chooses the place on the light.
        for (; pick < picks && (start + pick) * step < sum + double(scratch[light]); ++pick) {
            const auto place = float(std::clamp(((start + pick) * step - sum) / double(scratch[light]), 0.0, 1.0));
            const float across = evenly_spread(sample.index * picks + pick, sample.pattern).y;
            add_ray(light, point, scattering, float(step / double(scratch[light])),
                    {std::min(place, 0x1.fffffep-1f), across}, rays);
        }
        sum += scratch[light];
    }
}

} // namespace kokage
