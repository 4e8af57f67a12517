#include "reflection/glossy_light.h"
#include "common/directions/lobes.h"
#include "common/environment/lat_long.h"
#include "reflection/maps/make_baker.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

ShellSettings shell_settings(float least_roughness, float most_roughness) {
    ShellSettings settings;
    settings.kind = LobeKind::ggx;
    settings.least_parameter = least_roughness;
    settings.most_parameter = most_roughness;
    settings.filter = TexelFilter::cubic;
    settings.format = TexelFormat::float_rgb;
    return settings;
}

} // namespace

bool is_wide_for(const DistantLight& light, float roughness) {
    const float light_share = 1 - std::cos(std::min(light.half_angle, kPi));
    return light_share > float(1 / (1 + ggx_falloff(roughness))); // of the lobe, as sample_gloss draws it, half
}

glm::vec3 wide_lights_in(const Environment& environment, const glm::vec3& direction, float roughness) {
    const auto within = [&](const glm::vec3& towards, float half_angle) {
        return half_angle > 0 && glm::dot(direction, towards) >= std::cos(half_angle);
    };
    // A uniform cone of radiance L gives L π sin²(half angle) on a facing surface.
    const auto cone = [](float half_angle) { return kPi * std::sin(half_angle) * std::sin(half_angle); };
    glm::vec3 seen(0.f);
    for (const DistantLight& light : environment.distant_lights) {
        if (!is_wide_for(light, roughness) || !within(light.direction, light.half_angle))
            continue;
        if (light.texels.empty())
            seen += light.irradiance / cone(light.half_angle);
        for (const DistantLight::Texel& texel : light.texels)
            if (within(texel.direction, texel.half_angle))
                seen += texel.irradiance / cone(texel.half_angle);
    }
    return seen;
}

GlossyRemainder::GlossyRemainder(const Environment& environment, float least_roughness, float most_roughness,
                                 Progress& progress, WorkReport& report)
    : map_(shell_settings(least_roughness, most_roughness)), horizon_(LobeKind::ggx) {
    Environment remainder;
    remainder.remainder = with_square_pixels(environment.remainder);
    const std::unique_ptr<Baker> baker =
        is_same_everywhere(remainder)
            ? same_everywhere_baker(report)
            : make_baker(map_.layout(), remainder.remainder.width, remainder.remainder.height, {}, report, progress);
    std::vector<glm::vec3> filtered(map_.layout().size());
    baker->bake(remainder, filtered, report, progress);
    map_.set_texels(filtered);
}

glm::vec3 GlossyRemainder::radiance(const glm::vec3& normal, const glm::vec3& mirrored, float roughness) const {
    return filtered_above_horizon(
        horizon_, normal, mirrored, double(roughness),
        [&](const glm::vec3& direction, float parameter) { return map_.lookup(direction, double(parameter)); });
}

} // namespace kokage
