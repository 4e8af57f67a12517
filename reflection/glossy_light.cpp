#include "reflection/glossy_light.h"
#include "common/directions/lobes.h"
#include "common/environment/lat_long.h"
#include "common/services/count_text.h"
#include "reflection/maps/make_baker.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

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

std::size_t texels_to_bake(const ShellSettings& settings) {
    std::size_t texels = 0;
    for (const ShellMap::Shell& shell : ShellMap::plan(settings)) {
        const auto edge = std::size_t(shell.resolution + 2 * ShellMap::baked_border(settings.filter));
        texels += 6 * edge * edge;
    }
    return texels;
}

/// Against a map of all that surfaces usually have; narrower lobes than that would take gigabytes.
void report_range(float least_roughness, float most_roughness, WorkReport& report) {
    constexpr float kUsual = 0.1f;
    const std::size_t part = texels_to_bake(shell_settings(least_roughness, most_roughness)),
                      all = texels_to_bake(shell_settings(std::min(least_roughness, kUsual), 1));
    if (part >= all)
        return;
    const auto range = [](float least, float most) {
        std::array<char, 32> text;
        std::snprintf(text.data(), text.size(), "%.2g to %.2g", double(least), double(most));
        return std::string(text.data());
    };
    report.skips.push_back({"reflection map of other roughness",
                            "what is in view needs lobes of " + range(least_roughness, most_roughness),
                            count_text(all - part) + " of " + count_text(all) + " texels of " +
                                range(std::min(least_roughness, kUsual), 1)});
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
    report_range(least_roughness, most_roughness, report);
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
