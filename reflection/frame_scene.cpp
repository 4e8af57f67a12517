#include "reflection/picture.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace kokage {
namespace {

constexpr double kFieldOfView = 0.6; ///< vertical, radians: a 35 mm lens on full frame held upright, about
constexpr double kAirAbove = 0.90, kGroundBelow = 0.74, kAirBeside = 0.90; ///< how much of each half of the frame the scene fills
constexpr double kEyeHeight = 0.17; ///< of the scene's size: a person beside a tree of ten metres
constexpr double kAzimuth = 0.35;   ///< from +Z towards +X: a little to the side, so that symmetric things don't look flat

/// Where the camera stands and how it is tilted, in units of the scene, seen from `distance`.
struct Stand {
    glm::dvec3 position;
    double pitch;
};

struct Extent {
    double left = 0, right = 0, top = 0, bottom = 0; ///< in tangents of the angle from the view axis
};

Extent extent_of(const std::array<glm::dvec3, 8>& corners, const Stand& stand) {
    const glm::dvec3 level(-std::sin(kAzimuth), 0, -std::cos(kAzimuth)), side(std::cos(kAzimuth), 0, -std::sin(kAzimuth));
    Extent extent{1e9, -1e9, -1e9, 1e9};
    for (const glm::dvec3& corner : corners) {
        const glm::dvec3 offset = corner - stand.position;
        const double ahead = glm::dot(offset, level), up = offset.y;
        const double depth = ahead * std::cos(stand.pitch) + up * std::sin(stand.pitch);
        if (depth <= 1e-6)
            return {-1e9, 1e9, 1e9, -1e9}; // behind the camera: not in any frame
        const double x = glm::dot(offset, side) / depth, y = (up * std::cos(stand.pitch) - ahead * std::sin(stand.pitch)) / depth;
        extent = {std::min(extent.left, x), std::max(extent.right, x), std::max(extent.top, y), std::min(extent.bottom, y)};
    }
    return extent;
}

/// The pitch that puts the highest corner where kAirAbove wants it: by bisection, as a higher pitch lowers what is seen.
double pitch_for_top(const std::array<glm::dvec3, 8>& corners, const glm::dvec3& position, double tangent) {
    double low = -1.2, high = 1.2;
    for (int k = 0; k < 50; ++k) {
        const double middle = 0.5 * (low + high);
        (extent_of(corners, {position, middle}).top > kAirAbove * tangent ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

} // namespace

Camera frame_scene(const Bounds& bounds, float aspect) {
    const glm::dvec3 low(bounds.low), high(bounds.high);
    glm::dvec3 centre = 0.5 * (low + high), half = 0.5 * (high - low);
    const double size = std::max({2 * half.y, 2 * half.x, 2 * half.z});
    if (!(size > 0) || !std::isfinite(size) || !std::isfinite(glm::dot(centre, glm::dvec3(1.0))))
        return frame_scene({glm::vec3(-0.5f, 0.f, -0.5f), glm::vec3(0.5f, 1.f, 0.5f)}, aspect);
    half /= size;
    std::array<glm::dvec3, 8> corners; // in units of size, the middle of the scene's foot at the origin
    for (std::size_t k = 0; k < 8; ++k)
        corners[k] = {k & 1 ? half.x : -half.x, k & 2 ? 2 * half.y : 0, k & 4 ? half.z : -half.z};

    const double eye = std::max(kEyeHeight * 2 * half.y, 0.06) + 0.1 * std::max(0.0, 0.6 - 2 * half.y);
    const double tangent = std::tan(kFieldOfView / 2), wide = tangent * (std::isfinite(aspect) && aspect > 0 ? double(aspect) : 1);
    auto stand_at = [&](double distance) {
        const glm::dvec3 position(distance * std::sin(kAzimuth), eye, distance * std::cos(kAzimuth));
        return Stand{position, pitch_for_top(corners, position, tangent)};
    };
    auto fits = [&](const Extent& extent) {
        return extent.bottom >= -kGroundBelow * tangent && extent.top <= (kAirAbove + 1e-6) * tangent &&
               std::max(-extent.left, extent.right) <= kAirBeside * wide;
    };
    double near = 0.3, far = 1e4;
    for (int k = 0; k < 60; ++k) {
        const double middle = std::sqrt(near * far);
        (fits(extent_of(corners, stand_at(middle))) ? far : near) = middle;
    }
    const Stand stand = stand_at(far);

    const glm::dvec3 foot(centre.x, low.y, centre.z);
    const glm::dvec3 forward(-std::sin(kAzimuth) * std::cos(stand.pitch), std::sin(stand.pitch),
                             -std::cos(kAzimuth) * std::cos(stand.pitch));
    Camera camera;
    camera.position = foot + size * stand.position;
    camera.target = foot + size * (stand.position + far * forward);
    camera.vertical_field_of_view = float(kFieldOfView);
    return camera;
}

} // namespace kokage
