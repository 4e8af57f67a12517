#include "common/environment/lat_long.h"

#include <algorithm>
#include <cmath>

namespace kokage {

glm::vec2 lat_long_from_direction(const glm::vec3& direction) {
    float u = 0.5f + std::atan2(direction.z, direction.x) / (2 * kPi);
    u -= std::floor(u);
    return {u < 1.f ? u : 0.f, std::acos(std::clamp(direction.y, -1.f, 1.f)) / kPi};
}

glm::vec3 direction_from_lat_long(glm::vec2 uv) {
    const float azimuth = (uv.x - 0.5f) * 2 * kPi, polar = uv.y * kPi;
    const float sine = std::sin(polar);
    return {sine * std::cos(azimuth), std::cos(polar), sine * std::sin(azimuth)};
}

double pixel_solid_angle(int y, int width, int height) {
    // cos a - cos b = 2 sin((a+b)/2) sin((b-a)/2): no cancellation at the poles of tall images.
    const double step = kPiDouble / height;
    return 2 * kPiDouble / width * 2 * std::sin((y + 0.5) * step) * std::sin(0.5 * step);
}

glm::vec3 lat_long_radiance(const Image& image, const glm::vec3& direction) {
    const glm::vec2 uv = lat_long_from_direction(direction);
    const float x = uv.x * float(image.width) - 0.5f, y = uv.y * float(image.height) - 0.5f;
    const float fx = x - std::floor(x), fy = y - std::floor(y);
    const int x0 = (int(std::floor(x)) + image.width) % image.width, x1 = (x0 + 1) % image.width;
    const int y0 = std::clamp(int(std::floor(y)), 0, image.height - 1);
    const int y1 = std::clamp(int(std::floor(y)) + 1, 0, image.height - 1);
    auto pixel = [&](int px, int py) { return glm::vec3(image.at(px, py)[0], image.at(px, py)[1], image.at(px, py)[2]); };
    return (1 - fy) * ((1 - fx) * pixel(x0, y0) + fx * pixel(x1, y0)) + fy * ((1 - fx) * pixel(x0, y1) + fx * pixel(x1, y1));
}

} // namespace kokage
