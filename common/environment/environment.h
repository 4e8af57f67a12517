#pragma once
// Surroundings = lights + remainder. Lights (sun, lamps) are handled exactly; the remainder is smooth enough for SH.
#include "common/environment/lat_long.h"
#include "common/types.h"

#include <string>
#include <vector>

namespace kokage {

/// A light at infinity: a uniform disc (sun), a bare direction (half_angle 0), or a bright region cut out of an image.
struct DistantLight {
    /// One piece of a region: a pixel of the image it was cut from.
    struct Texel {
        glm::vec3 direction;
        glm::vec3 irradiance; ///< radiance x solid angle: what a surface facing it receives
        /// Of a cone with the solid angle of the pixel, or of the neighbouring pixels that it stands for.
        float half_angle = 0;
    };
    /// A pixel of the image that the region was cut from.
    struct Pixel {
        int x, y;
        glm::vec3 radiance; ///< that was taken from it
    };
    std::string name;             ///< "sun", "region 3 of 12 (u 0.41, v 0.22)", ...
    glm::vec3 direction{0, 1, 0}; ///< towards the light; a region's energy-weighted mean
    float half_angle = 0; ///< radians; of the disc, or of the smallest cone around `direction` that holds the region
    /// Of a disc: on an unshadowed surface that faces it. Of a region: the sum of its texels, radiance x solid angle.
    glm::vec3 irradiance{0.f};
    std::vector<Texel> texels; ///< empty for a disc
    /// Of a region, for who looks at it: each of its pixels, where texels stand for several. Empty: see the texels.
    std::vector<Pixel> pixels;
};

/// A light at a place. Irradiance at distance d on a facing surface = intensity / d^2.
struct PointLight {
    std::string name;
    glm::vec3 position{0.f};
    glm::vec3 intensity{0.f}; ///< W/sr in the scene's units
};

/// A direction towards a light, drawn with a probability; the estimate of irradiance is irradiance_over_pdf x visible x
/// |cos|.
struct LightSample {
    glm::vec3 direction;
    glm::vec3 irradiance_over_pdf;
};
/// Draws a direction of a distant light: uniformly on its disc, or a texel by its share of luminance, then within the
/// texel.
LightSample sample_light(const DistantLight& light, float u0, float u1);

/// A direction drawn uniformly in solid angle from the cone within `half_angle` of a unit axis.
glm::vec3 sample_cone(const glm::vec3& axis, float half_angle, float u0, float u1);

struct Environment {
    Image remainder; ///< lat-long RGB radiance with the lights taken out; at least 1x1
    std::vector<DistantLight> distant_lights;
    std::vector<PointLight> point_lights;
    bool has_lower_half = true; ///< false under the analytic sky: the scene then needs a ground
    std::string description;    ///< one line for reports: where it came from
};

/// What was found and done when an environment was loaded.
struct EnvironmentReport {
    std::size_t nan_pixels = 0, infinite_pixels = 0, negative_pixels = 0;
    int first_bad_x = -1, first_bad_y = -1;     ///< in raster order, of any kind
    int columns_before_reduction = 0;           ///< of an image that was reduced to EnvironmentLoading::max_width; or 0
    std::size_t regions_found = 0;              ///< bright regions before the limit of 64
    double energy_before = 0, energy_after = 0; ///< integral of luminance over the sphere
    std::string note;                           ///< one line a person can read; empty if there is nothing to say
    std::vector<std::string> warnings; ///< those parts of the note that tell that the image is not as it should be
};

} // namespace kokage
