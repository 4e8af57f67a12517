#include "reflection/backdrop_ground.h"
#include "reflection/ground_sky_light.h"

#include <algorithm>

namespace kokage {
namespace {

/// In the scene's radii: up to the first the light changes in full, from the second on not at all.
constexpr float kChanged = 4, kUnchanged = 12;

} // namespace

BackdropGround::BackdropGround(const Environment& environment, const Backdrop& backdrop, const GroundLook& look)
    : look_(look), open_irradiance_(GroundSkyLight::open_irradiance(backdrop)) {
    for (const DistantLight& light : environment.distant_lights)
        for (const DistantLight::Texel& texel : light.texels)
            open_irradiance_ += texel.irradiance * std::max(0.f, texel.direction.y);
}

BackdropGround::Share BackdropGround::share(const glm::vec3& point, const glm::vec3& shown,
                                            const glm::vec3& lights) const {
    const float near = std::clamp((kUnchanged - look_.away(point)) / (kUnchanged - kChanged), 0.f, 1.f);
    Share share{shown + lights, glm::vec3(0.f)};
    if (near <= 0)
        return share;
    const float change = near * near * (3 - 2 * near);
    for (glm::length_t c = 0; c < 3; ++c)
        if (open_irradiance_[c] > 0) {
            share.albedo[c] = std::min(change * shown[c] * kPi / open_irradiance_[c], 1.f);
            share.unchanged[c] -= share.albedo[c] / kPi * open_irradiance_[c];
        }
    share.unchanged = glm::max(share.unchanged, glm::vec3(0.f));
    return share;
}

} // namespace kokage
