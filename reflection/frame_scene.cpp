#include "reflection/picture.h"

#include "common/geometry/support_points.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

/// How much of each half of the frame the scene fills: above, below (ground in front shows its shadow) and beside the
/// middle.
constexpr double kFillAbove = 0.88, kFillBelow = 0.70, kFillBeside = 0.88;
constexpr double kEyeHeight = 0.2; ///< of the scene's height: a person beside a tree of eight metres
constexpr int kSupportDirections = 400;

/// Where the camera stands, in units of the scene's size from the middle of its foot, and how it is turned.
struct Stand {
    glm::dvec3 position;
    double azimuth, pitch;
};

struct Extent {
    double beside = 0, top = 0, bottom = 0; ///< in tangents of the angle from the view axis
};

constexpr Extent kBehindTheCamera{1e9, 1e9, -1e9};

Extent extent_of(const std::vector<glm::dvec3>& points, const Stand& stand) {
    const double sine = std::sin(stand.azimuth), cosine = std::cos(stand.azimuth);
    const double tilt_up = std::sin(stand.pitch), tilt_ahead = std::cos(stand.pitch);
    Extent extent{0, -1e9, 1e9};
    for (const glm::dvec3& point : points) {
        const glm::dvec3 offset = point - stand.position;
        const double ahead = -sine * offset.x - cosine * offset.z, side = cosine * offset.x - sine * offset.z;
        const double depth = ahead * tilt_ahead + offset.y * tilt_up;
        if (depth <= 1e-6)
            return kBehindTheCamera;
        const double y = (offset.y * tilt_ahead - ahead * tilt_up) / depth;
        extent = {std::max(extent.beside, std::abs(side) / depth), std::max(extent.top, y), std::min(extent.bottom, y)};
    }
    return extent;
}

/// The pitch at which the scene's top and bottom are equally far into the parts of the frame that they may fill: by
/// bisection, as tilting the camera up lowers all that it sees.
double balanced_pitch(const std::vector<glm::dvec3>& points, Stand stand) {
    double low = -1.2, high = 1.2;
    for (int k = 0; k < 40; ++k) {
        stand.pitch = 0.5 * (low + high);
        const Extent extent = extent_of(points, stand);
        (extent.top * kFillBelow + extent.bottom * kFillAbove > 0 ? low : high) = stand.pitch;
    }
    return 0.5 * (low + high);
}

/// Stands as near as the points allow. `points`: in the scene's units, relative to `foot`; `height`: of the highest.
Camera stand_before(const std::vector<glm::dvec3>& points, double height, const glm::dvec3& foot, double size,
                    float aspect, double azimuth, double field_of_view) {
    const double tangent = std::tan(field_of_view / 2);
    const double wide = tangent * (std::isfinite(aspect) && aspect > 0 ? double(aspect) : 1);
    // Low, wide things (a fern, a row of trees) are looked at from a little higher than a tree.
    const double eye = kEyeHeight * height + 0.15 * std::max(0.0, 0.7 - height);
    auto stand_at = [&](double distance) {
        Stand stand{{distance * std::sin(azimuth), eye, distance * std::cos(azimuth)}, azimuth, 0};
        stand.pitch = balanced_pitch(points, stand);
        return stand;
    };
    double near = 0.05, far = 1e4;
    for (int k = 0; k < 40; ++k) {
        const double middle = std::sqrt(near * far);
        const Extent extent = extent_of(points, stand_at(middle));
        const bool fits = extent.bottom >= -kFillBelow * tangent && extent.top <= kFillAbove * tangent &&
                          extent.beside <= kFillBeside * wide;
        (fits ? far : near) = middle;
    }
    const Stand stand = stand_at(far);
    const glm::dvec3 forward(-std::sin(azimuth) * std::cos(stand.pitch), std::sin(stand.pitch),
                             -std::cos(azimuth) * std::cos(stand.pitch));
    Camera camera;
    camera.position = foot + size * stand.position;
    camera.target = foot + size * (stand.position + far * forward);
    camera.vertical_field_of_view = float(field_of_view);
    return camera;
}

Camera frame_points(const std::vector<glm::vec3>& points, const Bounds& bounds, float aspect, double azimuth,
                    double field_of_view) {
    const glm::dvec3 low(bounds.low), extent = glm::dvec3(bounds.high) - low;
    const double size = std::max({extent.x, extent.y, extent.z});
    if (!(size > 0) || !std::isfinite(size) || !std::isfinite(glm::dot(low, glm::dvec3(1.0))))
        return frame_scene(Bounds{glm::vec3(-0.5f, 0.f, -0.5f), glm::vec3(0.5f, 1.f, 0.5f)}, aspect, float(azimuth),
                           float(field_of_view));
    const glm::dvec3 foot(low.x + 0.5 * extent.x, low.y, low.z + 0.5 * extent.z);
    std::vector<glm::dvec3> scaled;
    for (const glm::vec3& point : points)
        scaled.push_back((glm::dvec3(point) - foot) / size);
    return stand_before(scaled, extent.y / size, foot, size, aspect, azimuth, field_of_view);
}

/// The corners of all triangles, each once.
std::vector<glm::vec3> drawn_corners(const PatchScene& scene) {
    std::vector<std::uint8_t> drawn(scene.positions.size(), 0);
    for (const glm::uvec3& triangle : scene.triangles)
        drawn[triangle.x] = drawn[triangle.y] = drawn[triangle.z] = 1;
    std::vector<glm::vec3> corners;
    for (std::size_t i = 0; i < drawn.size(); ++i)
        if (drawn[i])
            corners.push_back(scene.positions[i]);
    return corners;
}

} // namespace

Camera frame_scene(const Bounds& bounds, float aspect, float azimuth, float field_of_view) {
    std::vector<glm::vec3> corners;
    for (unsigned k = 0; k < 8; ++k)
        corners.emplace_back(k & 1 ? bounds.high.x : bounds.low.x, k & 2 ? bounds.high.y : bounds.low.y,
                             k & 4 ? bounds.high.z : bounds.low.z);
    return frame_points(corners, bounds, aspect, double(azimuth), double(field_of_view));
}

Camera frame_scene(const PatchScene& scene, float aspect, float azimuth, float field_of_view) {
    // The farthest corners in many directions stand for all: what is between them is inside their hull.
    std::vector<glm::vec3> directions, support;
    for (int k = 0; k < kSupportDirections; ++k) {
        const float y = 1 - 2 * (float(k) + 0.5f) / kSupportDirections, ring = std::sqrt(1 - y * y),
                    turn = 2.39996323f * float(k);
        directions.emplace_back(ring * std::cos(turn), y, ring * std::sin(turn));
    }
    const std::vector<glm::vec3> corners = drawn_corners(scene);
    for (const std::uint32_t corner : support_points(corners, directions))
        support.push_back(corners[corner]);
    const Bounds bounds = bounds_of(scene);
    return frame_points(support, bounds, aspect, double(azimuth), double(field_of_view));
}

float photographers_azimuth(const Environment& environment) {
    const DistantLight* main = nullptr;
    for (const DistantLight& light : environment.distant_lights)
        if (light.direction.y > 0 && (!main || luminance(light.irradiance) > luminance(main->irradiance)))
            main = &light;
    constexpr float kDefault = 0.35f, kFromLight = 1.05f; // sixty degrees
    if (!main || !(glm::length(glm::vec2(main->direction.x, main->direction.z)) > 1e-6f))
        return kDefault;
    return std::atan2(main->direction.x, main->direction.z) + kFromLight;
}

} // namespace kokage
