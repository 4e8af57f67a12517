#pragma once
// Camera rays on shaded surfaces: the picture code that the integrated renderer grows from.
#include "common/environment/environment.h"
#include "common/scene/image.h"
#include "common/scene/patch_scene.h"
#include "common/services/progress.h"
#include "common/trace/ray_queries.h"

#include <memory>
#include <optional>
#include <vector>

namespace kokage {

struct Camera {
    glm::vec3 position{0.f}, target{0.f}, up{0, 1, 0};
    float vertical_field_of_view = 0.6f; ///< radians
};

/// How a patch looks: its base colour texture varies the radiance that was solved for its mean colour.
struct SurfaceLook {
    glm::vec3 base_color{1.f};                       ///< linear
    std::shared_ptr<const Image> base_color_texture; ///< linear RGB; null = none
    glm::vec3 mean_base_color{1.f};                  ///< alpha-weighted mean that the solution was computed with
    TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;
    bool smooth_normals = false;                     ///< bark: light with the interpolated normal
};

/// A scene of patches with solved light as attributes. `reflection` knows nothing of trees or methods.
struct ShadedScene {
    const PatchScene* patches = nullptr;
    std::vector<glm::vec3> normals;           ///< per position; may be empty
    std::vector<SurfaceLook> looks;           ///< indexed by triangle_look
    std::vector<std::uint32_t> triangle_look; ///< per triangle
    std::vector<glm::vec3> indirect_front, indirect_back; ///< per patch: radiance without the split-off lights
    std::vector<glm::vec3> radiance_front, radiance_back; ///< per patch: all light (used where per-pixel shadows are off)
};

struct PictureOptions {
    int width = 1280, height = 960;
    int samples = 16;                 ///< camera rays a pixel
    int light_samples = 1;            ///< shadow rays a light and camera ray
    std::optional<float> exposure_stops; ///< empty = automatic
    bool pixel_shadows = true;
    std::uint64_t seed = 1;
};

/// A camera that shows all of a scene, from a little above eye level.
Camera frame_scene(const Bounds& bounds, float aspect);

/// Linear radiance picture, 3 channels. The ground is lit per pixel: lights shadow-tested, sky by hemisphere samples, tree light bounced in.
Image render_picture(const ShadedScene& scene, const RayQueries& queries, const Environment& environment, const Camera& camera,
                     const PictureOptions& options, Progress& progress);

/// Display-ready sRGB bytes (as 0..1 floats) from linear radiance: exposure (automatic: log-average to middle grey), filmic curve.
Image tone_map(const Image& radiance, std::optional<float> exposure_stops);

} // namespace kokage
