#pragma once
// What a camera may see at all. Private to reflection.
#include "reflection/camera_rays.h"

#include <array>
#include <utility>

namespace kokage {

/// How large a pixel is at unit distance in the middle of the picture.
inline float pixel_size(const CameraFrame& frame) {
    return 2 * glm::length(frame.up) / float(frame.height);
}

class ViewFrustum {
  public:
    explicit ViewFrustum(const CameraFrame& frame)
        : position_(frame.position), forward_(frame.forward), pixel_(pixel_size(frame)) {
        const float right = glm::length(frame.right), up = glm::length(frame.up);
        sides_ = {
            {{frame.right / right, right}, {-frame.right / right, right}, {frame.up / up, up}, {-frame.up / up, up}}};
    }

    /// False where nothing of a sphere is in the picture, its pixel filter's reach of a pixel and a half included.
    bool may_see(const glm::vec3& centre, float radius) const {
        const glm::vec3 offset = centre - position_;
        const float ahead = glm::dot(offset, forward_);
        if (ahead < -radius)
            return false;
        const float reach = radius + 3 * pixel_ * std::max(ahead, 0.f);
        for (const auto& [axis, half] : sides_)
            if ((glm::dot(offset, axis) - half * ahead) / std::sqrt(1 + half * half) > reach)
                return false;
        return true;
    }

  private:
    glm::vec3 position_, forward_;
    float pixel_;
    std::array<std::pair<glm::vec3, float>, 4> sides_; ///< outwards across, half a picture
};

} // namespace kokage
