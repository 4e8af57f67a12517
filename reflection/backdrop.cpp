#include "reflection/backdrop.h"
#include "reflection/sampling.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

/// Cubic B-spline lookup, wrapping in u; rows outside [0, last_row] repeat the border row. A backdrop is enlarged
/// tenfold in a picture, and bilinear interpolation would show its diamonds.
glm::vec3 smooth_lookup(const Image& image, const glm::vec3& direction, int last_row) {
    const glm::vec2 uv = lat_long_from_direction(direction);
    const float x = uv.x * float(image.width) - 0.5f;
    const float y = std::min(uv.y * float(image.height) - 0.5f, float(last_row));
    const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
    const glm::vec4 wx = cubic_b_spline(x - float(x0)), wy = cubic_b_spline(y - float(y0));
    glm::vec3 sum(0.f);
    for (int j = 0; j < 4; ++j) {
        const int row = std::clamp(y0 + j - 1, 0, last_row);
        glm::vec3 line(0.f);
        for (int i = 0; i < 4; ++i) {
            const int column = ((x0 + i - 1) % image.width + image.width) % image.width;
            const float* pixel = image.at(column, row);
            line += wx[std::size_t(i)] * glm::vec3(pixel[0], pixel[1], pixel[2]);
        }
        sum += wy[std::size_t(j)] * line;
    }
    return sum;
}

} // namespace

Backdrop::Backdrop(const Environment& environment) : environment_(environment) {
    const Image& image = environment.remainder;
    for (const DistantLight& light : environment.distant_lights) {
        if (light.texels.empty()) {
            // Irradiance on a facing surface = radiance x π sin² (half angle).
            const double sine = std::sin(double(light.half_angle));
            if (light.half_angle > 0)
                discs_.push_back({light.direction, float(4 * std::pow(std::sin(0.5 * double(light.half_angle)), 2)),
                                  glm::vec3(glm::dvec3(light.irradiance) / (kPiDouble * sine * sine))});
            continue;
        }
        if (regions_.empty())
            regions_ = Image(image.width, image.height, 3);
        const auto add = [&](int x, int y, const glm::vec3& radiance) {
            for (int c = 0; c < 3; ++c)
                regions_.at(x, y)[c] += radiance[c];
        };
        for (const DistantLight::Pixel& pixel : light.pixels)
            if (pixel.x >= 0 && pixel.x < image.width && pixel.y >= 0 && pixel.y < image.height)
                add(pixel.x, pixel.y, pixel.radiance);
        if (!light.pixels.empty())
            continue;
        for (const DistantLight::Texel& texel : light.texels) {
            const glm::vec2 uv = lat_long_from_direction(texel.direction);
            const int x = std::clamp(int(uv.x * float(image.width)), 0, image.width - 1);
            const int y = std::clamp(int(uv.y * float(image.height)), 0, image.height - 1);
            const auto solid_angle = float(pixel_solid_angle(y, image.width, image.height));
            add(x, y, texel.irradiance / solid_angle);
        }
    }
}

glm::vec3 Backdrop::remainder(const glm::vec3& direction) const {
    const Image& image = environment_.remainder;
    const int last_row = environment_.has_lower_half ? image.height - 1 : std::max(0, image.height / 2 - 1);
    return smooth_lookup(image, direction, last_row);
}

glm::vec3 Backdrop::lights(const glm::vec3& direction) const {
    glm::vec3 radiance(0.f);
    if (!regions_.empty())
        radiance += smooth_lookup(regions_, direction, regions_.height - 1);
    for (const Disc& disc : discs_)
        if (const glm::vec3 chord = direction - disc.direction; glm::dot(chord, chord) <= disc.squared_chord)
            radiance += disc.radiance;
    return radiance;
}

} // namespace kokage
