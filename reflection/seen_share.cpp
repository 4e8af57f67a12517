#include "reflection/seen_share.h"

#include <algorithm>

namespace kokage {

double pixels_of_patch(const PatchScene& scene, const Patch& patch, bool front, const CameraFrame& frame) {
    const double pixel = 4 * double(glm::length(frame.right)) * double(glm::length(frame.up)) /
                         (double(frame.width) * double(frame.height)); // at unit distance ahead
    double pixels = 0;
    for (std::uint32_t t = patch.first_triangle; t < patch.first_triangle + patch.triangle_count; ++t) {
        const glm::uvec3 corners = scene.triangles[t];
        const glm::dvec3 a = scene.positions[corners.x], b = scene.positions[corners.y], c = scene.positions[corners.z];
        const glm::dvec3 offset = (a + b + c) / 3. - glm::dvec3(frame.position);
        const double ahead = glm::dot(offset, glm::dvec3(frame.forward));
        const double towards = -0.5 * glm::dot(glm::cross(b - a, c - a), offset) * (front ? 1 : -1);
        // Solid angle over that of a pixel, which shrinks off the axis as the cube of the cosine.
        if (towards > 0 && ahead > 0)
            pixels += towards / (ahead * ahead * ahead * pixel);
    }
    return pixels;
}

} // namespace kokage
