#include "reflection/glossy_light.h"
#include "common/directions/lobes.h"
#include "common/environment/lat_long.h"
#include "common/environment/light_radiance.h"
#include "common/services/count_text.h"
#include "reflection/maps/lobe_width.h"
#include "reflection/maps/make_baker.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace kokage {
namespace {

/// Narrower lobes than half a pixel blur the image no less to see, and take texels as the square of what they are
/// narrower (123 million, 7 GB, for a mirror's). Images of less than 200 columns are smooth ones that stand for a sky:
/// there lobes may be as narrow as costs nothing. Finer ones than of 1,000 columns are not shown finer.
double finest_roughness(const Image& image) {
    constexpr double kPixels = 0.5, kFinest = 0.0015, kCheap = 0.008; // widths in radians
    const double pixel = 2 * kPiDouble / std::max(image.width, 1);
    return lobe_of_width(LobeKind::ggx, std::clamp(kPixels * pixel, kFinest, kCheap)).parameter;
}

/// The horizon's correction reads narrower lobes than the surface's own, but of those that are narrow themselves only
/// where a surface is seen within a degree or two of its plane.
float least_read(float least_roughness) {
    constexpr float kOfOwn = 0.4f, kNarrow = 0.12f;
    return std::max(kOfOwn * least_roughness, std::min(least_roughness, kNarrow));
}

ShellSettings shell_settings(const Image& image, float least_roughness, float most_roughness) {
    const double finest = finest_roughness(image);
    ShellSettings settings;
    settings.kind = LobeKind::ggx;
    settings.least_parameter = std::max(double(least_roughness), finest);
    settings.most_parameter = std::max(double(most_roughness), finest);
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

void report_narrowest(const Image& image, float least_roughness, WorkReport& report) {
    const double finest = finest_roughness(image);
    if (!(double(least_roughness) < finest))
        return;
    std::array<char, 48> narrower;
    std::array<char, 64> texels;
    std::snprintf(narrower.data(), narrower.size(), "lobes narrower than of roughness %.2g", finest);
    std::snprintf(texels.data(), texels.size(), "about %.2g times as many texels",
                  std::pow(finest / double(least_roughness), 4));
    report.skips.push_back({narrower.data(), "the surroundings' pixels are wider", texels.data()});
}

/// Against a map of all that surfaces usually have; narrower lobes than that would take gigabytes.
void report_range(const Image& image, float least_roughness, float most_roughness, WorkReport& report) {
    constexpr float kUsual = 0.1f;
    const std::size_t part = texels_to_bake(shell_settings(image, least_roughness, most_roughness)),
                      all = texels_to_bake(shell_settings(image, std::min(least_roughness, kUsual), 1));
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
    glm::vec3 seen(0.f);
    for (const DistantLight& light : environment.distant_lights)
        if (is_wide_for(light, roughness))
            seen += radiance_along(light, direction);
    return seen;
}

GlossyRemainder::GlossyRemainder(const Environment& environment, float least_roughness, float most_roughness,
                                 Progress& progress, WorkReport& report)
    : map_(shell_settings(environment.remainder, least_read(least_roughness), most_roughness)),
      horizon_(LobeKind::ggx) {
    report_narrowest(environment.remainder, least_read(least_roughness), report);
    report_range(environment.remainder, least_read(least_roughness), most_roughness, report);
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
