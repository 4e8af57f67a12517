#include "reflection/open_irradiance.h"
#include "common/environment/lat_long.h"

#include <algorithm>

namespace kokage {
namespace {

constexpr int kLightWidth = 64, kNormalWidth = 32; ///< irradiance is smooth: within 1 %

} // namespace

OpenIrradiance::OpenIrradiance(const Environment& environment, const std::optional<Ground>& ground)
    : irradiance_(kNormalWidth, kNormalWidth / 2, 3) {
    const Image light = reduce_lat_long(environment.remainder, kLightWidth);
    struct Texel {
        glm::vec3 direction, radiance; ///< times its solid angle
    };
    std::vector<Texel> texels;
    glm::dvec3 on_ground(0.);
    for (int y = 0; y < light.height; ++y)
        for (int x = 0; x < light.width; ++x) {
            const glm::vec3 direction(pixel_direction(x, y, light.width, light.height));
            const float* rgb = light.at(x, y);
            const glm::vec3 radiance =
                glm::vec3(rgb[0], rgb[1], rgb[2]) * float(pixel_solid_angle(y, light.width, light.height));
            if (direction.y < 0 && ground)
                continue;
            texels.push_back({direction, radiance});
            on_ground += glm::dvec3(radiance * std::max(0.f, direction.y));
        }
    for (const DistantLight& sun : environment.distant_lights)
        on_ground += glm::dvec3(sun.irradiance * std::max(0.f, sun.direction.y));
    for (int y = 0; y < irradiance_.height; ++y)
        for (int x = 0; x < irradiance_.width; ++x) {
            const glm::vec3 normal(pixel_direction(x, y, irradiance_.width, irradiance_.height));
            glm::dvec3 sum(0.);
            for (const Texel& texel : texels)
                sum += glm::dvec3(texel.radiance * std::max(0.f, glm::dot(normal, texel.direction)));
            if (ground) // an even half sphere of it: E = pi L (1 - n.y) / 2
                sum += glm::dvec3(ground->albedo) * on_ground * (0.5 * (1 - double(normal.y)));
            for (int c = 0; c < 3; ++c)
                irradiance_.at(x, y)[c] = float(sum[std::size_t(c)]);
        }
}

glm::vec3 OpenIrradiance::at(const glm::vec3& normal) const {
    return lat_long_radiance(irradiance_, normal);
}

} // namespace kokage
