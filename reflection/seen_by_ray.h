#pragma once
// What one camera ray saw, in parts, and the mean of a pixel's rays as layers. Private to reflection.
#include "reflection/camera_rays.h"
#include "reflection/surface_shading.h"

#include <limits>
#include <vector>

namespace kokage {

/// Tells apart what rays meet, so that rays that meet the same have much the same radiance: surroundings, the ground,
/// or one side of a patch.
namespace seen_part {
constexpr std::uint32_t kSurroundings = 0, kGround = 1, kFirstSurface = 2;
inline std::uint32_t of_patch(std::uint32_t patch, bool front) {
    return kFirstSurface + 2 * patch + !front;
}
} // namespace seen_part

/// Of a surface or the ground: radiance = direct + indirect + reflection. Of surroundings: radiance alone.
struct SeenByRay {
    glm::vec3 radiance{0.f}, direct{0.f}, indirect{0.f}, reflection{0.f};
    glm::vec3 albedo{0.f}, normal{0.f};
    float distance = std::numeric_limits<float>::infinity(); ///< infinite: surroundings
    std::uint32_t leaf = 0;                                  ///< its number, from 1; 0: no leaf
    std::uint32_t part = seen_part::kSurroundings;
    bool surface = false; ///< neither ground nor surroundings

    static SeenByRay surface_at(const SurfacePoint& at, float distance, const PatchScene& patches,
                                const SurfaceRadiance& light);
    static SeenByRay ground_at(const glm::vec3& albedo, float distance, const SurfaceRadiance& light);
    static SeenByRay surroundings(const glm::vec3& radiance);

  private:
    void take(const SurfaceRadiance& light);
};

/// An empty picture of a size, with the layers that the options ask for.
Picture empty_picture(const PictureOptions& options);

/// Of equals the smallest; sorts them.
std::uint32_t most_frequent(std::vector<std::uint32_t>& values);

/// Adds up one pixel's rays; reused for the next pixel. One thread's.
class PixelSum {
  public:
    PixelSum(const CameraFrame& frame, bool layers) : frame_(frame), layers_(layers) {}

    void clear();
    void add(const SeenByRay& seen, const glm::vec3& direction);
    std::uint32_t count() const { return count_; }
    /// Means, into the pixel of `picture`.
    void store(Picture& picture, int x, int y) const;

  private:
    void store_layers(PictureLayers& layers, int x, int y) const;

    const CameraFrame& frame_;
    bool layers_;
    std::uint32_t count_ = 0, surfaces_ = 0;
    glm::dvec3 radiance_{0.}, direct_{0.}, indirect_{0.}, reflection_{0.}, albedo_{0.};
    glm::vec3 normal_{0.f};
    float depth_ = std::numeric_limits<float>::infinity();
    mutable std::vector<std::uint32_t> leaves_; ///< of every ray
};

} // namespace kokage
