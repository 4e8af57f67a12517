#include "reflection/gloss.h"
#include "common/directions/about_axis.h"
#include "common/directions/lobes.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

glm::vec3 grazing_reflectance(const glm::vec3& normal_reflectance, float roughness) {
    return glm::max(glm::vec3(1 - roughness), normal_reflectance);
}

/// The lobe is proportional to (1 - w)/(1 + x w)², w = 1 - cos θ in 0 … 1. Directions are drawn by 1/(1 + x w)² alone,
/// whose integral over the hemisphere is 2π/(1 + x).
float drawn_density(double falloff, double w) {
    const double fall = 1 + falloff * w;
    return float((1 + falloff) / (2 * kPiDouble * fall * fall));
}

} // namespace

float RoughnessGradient::at(float height) const {
    const float span = top_height - foot_height;
    const float share = span > 0 ? std::clamp((height - foot_height) / span, 0.f, 1.f) : 0.f;
    return foot + (top - foot) * share;
}

RoughnessBounds roughness_bounds(const Gloss& gloss) {
    RoughnessBounds range{gloss.roughness, gloss.roughness, gloss.roughness};
    if (const auto& gradient = gloss.roughness_gradient)
        range = {std::min(gradient->foot, gradient->top), std::max(gradient->foot, gradient->top),
                 0.5f * (gradient->foot + gradient->top)};
    if (!gloss.roughness_texture || gloss.roughness_texture->empty())
        return range;
    const Image& texture = *gloss.roughness_texture;
    float least = texture.pixels.front(), most = least;
    double sum = 0;
    for (std::size_t k = 0; k < texture.pixels.size(); k += std::size_t(texture.channels)) {
        least = std::min(least, texture.pixels[k]);
        most = std::max(most, texture.pixels[k]);
        sum += double(texture.pixels[k]);
    }
    const double mean = sum / (double(texture.width) * texture.height);
    return {range.least * least, range.most * most, float(double(range.mean) * mean)};
}

glm::vec3 gloss_reflectance(const glm::vec3& normal_reflectance, float roughness, float cosine) {
    const float away = 1 - std::clamp(cosine, 0.f, 1.f), fifth = away * away * away * away * away;
    return normal_reflectance + (grazing_reflectance(normal_reflectance, roughness) - normal_reflectance) * fifth;
}

glm::vec3 mean_gloss_reflectance(const glm::vec3& normal_reflectance, float roughness) {
    // The integral of 2 c (1 - c)^5 over c in 0 … 1 is 1/21.
    return normal_reflectance + (grazing_reflectance(normal_reflectance, roughness) - normal_reflectance) / 21.f;
}

LobeSample sample_gloss(const glm::vec3& mirrored, float roughness, glm::vec2 numbers) {
    const double falloff = ggx_falloff(std::max(roughness, kLeastRoughness));
    // Share of what is drawn within w: w (1 + x)/(1 + x w).
    const double w = numbers.x / (1 + falloff * (1 - double(numbers.x)));
    const double sine = std::sqrt(std::max(0., w * (2 - w))), azimuth = 2 * kPiDouble * numbers.y;
    const glm::dvec3 local(sine * std::cos(azimuth), 1 - w, sine * std::sin(azimuth));
    const glm::vec3 unit(about_axis(local, glm::dvec3(mirrored)));
    const float density = drawn_density(falloff, w);
    const double lobe = ggx_lobe_value(std::max(roughness, kLeastRoughness), 2 * w);
    return {unit, density > 0 ? float(lobe / density) : 0.f, density};
}

float gloss_density(const glm::vec3& mirrored, float roughness, const glm::vec3& direction) {
    const glm::dvec3 apart = glm::dvec3(mirrored) - glm::dvec3(direction);
    const double w = 0.5 * glm::dot(apart, apart);
    return w <= 1 ? drawn_density(ggx_falloff(std::max(roughness, kLeastRoughness)), w) : 0.f;
}

} // namespace kokage
