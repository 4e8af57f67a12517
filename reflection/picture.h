#pragma once
// Camera rays on shaded surfaces: the picture code that the integrated renderer grows from.
#include "common/environment/environment.h"
#include "common/scene/image.h"
#include "common/scene/light_map.h"
#include "common/scene/patch_scene.h"
#include "common/services/progress.h"
#include "common/services/work_report.h"
#include "common/trace/ray_queries.h"
#include "reflection/gloss.h"
#include "reflection/relief/height_field.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

namespace kokage {

struct Camera {
    glm::vec3 position{0.f}, target{0.f}, up{0, 1, 0};
    float vertical_field_of_view = 0.6f; ///< radians
};

/// Relief below a surface, in the tile that its texture coordinates tell (relief/surface_relief.h): the mesh is its
/// highest level. Camera rays meet it where it is near enough to be seen; all other rays meet the mesh.
struct LookRelief {
    std::shared_ptr<const HeightField> heights; ///< null: none; looks that share it share what is made of it
    float depth_m = 0;                          ///< from its highest to its lowest level (depth 1)
    /// The size of a tile that depth_m is meant for: where texture narrows along a branch, relief gets shallower as
    /// well. 0: depth_m holds everywhere.
    float tile_m = 0;
};

/// How a patch looks: its base colour texture varies the radiance that was solved for its mean colour.
/// The radiance of a point = solved radiance x base_color x texture / mean_base_color, per channel.
struct SurfaceLook {
    glm::vec3 base_color{1.f};                       ///< linear
    std::shared_ptr<const Image> base_color_texture; ///< linear RGB; null = none
    glm::vec3 mean_base_color{1.f}; ///< alpha-weighted mean of base_color x texture, as the solution used it
    TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;
    Gloss gloss;
    bool smooth_normals = false; ///< bark: light with the interpolated normal, and blend solved radiance across patches
    /// Normals in the tangent frame, 0..1 for -1..1, red towards larger u, green towards smaller v (glTF's); null =
    /// none. They turn the normal by which sun, lamps and gloss are seen; the light that was solved does not turn with
    /// them.
    std::shared_ptr<const Image> normal_texture;
    float normal_scale = 1; ///< times their slopes
    LookRelief relief;      ///< of closed, opaque surfaces; needs texture coordinates and normals
};

/// A scene of patches with solved light as attributes. `reflection` knows nothing of trees or methods.
struct ShadedScene {
    const PatchScene* patches = nullptr;
    std::vector<glm::vec3> normals;           ///< per position; may be empty
    std::vector<SurfaceLook> looks;           ///< indexed by triangle_look; empty = every patch has its mean colour
    std::vector<std::uint32_t> triangle_look; ///< per triangle; empty if looks is
    std::vector<glm::vec3> indirect_front, indirect_back; ///< per patch: radiance without the split-off lights
    /// Per patch: what gloss sends on of the same light, spread as if it were diffuse; for rays that meet the patch
    /// after the camera's. Empty: nothing is glossy.
    std::vector<glm::vec3> gloss_front, gloss_back;
    std::vector<glm::vec3> radiance_front,
        radiance_back; ///< per patch: all light, with what gloss mirrors as if it scattered it
    /// Of smooth surfaces: what arrives about them, split-off lights apart. Rough gloss there is lit by them in place
    /// of rays (light_map_readers.h tells where). Empty: rays light all gloss.
    LightMapsOfPatches light_maps;
    std::optional<float> foot_height; ///< where it stands if it has no ground of its own; empty = its lowest point
};

/// What lies under the scene in the picture.
enum class PictureGround {
    /// The scene's own ground if it has one. Else, where the environment has a lower half, that half stays and only
    /// takes the scene's shadow and bounced light, near the scene. Else a plane of albedo 0.2 under the lowest point.
    automatic,
    none ///< nothing but the scene's own ground
};

/// What render_picture does not do where it does not show. Each can be switched off, so that what it saves and what it
/// changes can be measured.
struct PictureSkips {
    bool bake_of_matt = true;      ///< a reflection map where nothing glossy is in view
    bool lobes_out_of_view = true; ///< roughness in reflection maps that nothing in view has
    bool thin_relief = true;       ///< relief_strength: relief whose depth covers less than a quarter of a pixel (path
                                   ///< tracing leaves it out as well)
};

struct PictureOptions {
    int width = 1280, height = 960;
    int samples = 16;      ///< camera rays a pixel; render_picture: in the mean, more where they differ (from 8 on)
    int light_samples = 1; ///< shadow rays a light and camera ray; beyond six lights: 2 x this, chosen by contribution
    /// render_picture: rays a pixel that correct the solved light where the camera looks (final_gather.h). Empty: a
    /// quarter of `samples`, 1 to 16; with them a coarse solution does as well as a fine one. 0: the picture shows what
    /// was solved.
    std::optional<int> gather_rays;
    std::optional<float> exposure_stops; ///< empty = automatic; for tone_map
    bool pixel_shadows = true; ///< else surfaces show the light that was solved for their patches, gloss in it
    PictureGround ground = PictureGround::automatic;
    std::uint64_t seed = 1;
    bool layers = false;                 ///< also Picture::layers
    int every_row = 1, every_column = 1; ///< path tracing: is_traced(); all other pixels stay black
    PictureSkips skips;
};

/// So that a truth of some of a picture's pixels is cheap: every so manieth row, and in it every so manieth pixel,
/// shifted from row to row.
inline bool is_traced(const PictureOptions& options, int x, int y) {
    const int rows = options.every_row > 1 ? options.every_row : 1,
              columns = options.every_column > 1 ? options.every_column : 1;
    return y % rows == 0 && (x + 3 * (y / rows)) % columns == 0;
}

inline int gather_rays_of(const PictureOptions& options) {
    return options.gather_rays.value_or(std::clamp(options.samples / 4, 1, 16));
}

/// A camera that shows all of a scene, from a little above the ground, as a photographer would: level with a person's
/// eyes beside a grown tree, some ground in front, air around. It stands at `azimuth` (radians from +Z towards +X) seen
/// from the scene. Works at any size; a zero or non-finite box is taken as 1 m at the origin. `field_of_view`:
/// vertical, radians; 0.6 is about a 35 mm lens on full frame.
Camera frame_scene(const PatchScene& scene, float aspect, float azimuth = 0.35f, float field_of_view = 0.6f);
/// The same for a box, all of whose corners are shown.
Camera frame_scene(const Bounds& bounds, float aspect, float azimuth = 0.35f, float field_of_view = 0.6f);

/// Where a photographer would stand: the strongest light above the horizon comes from sixty degrees aside, so that the
/// crown has a bright and a dark half and its shadow falls across the ground. 0.35 if there is no such light or it
/// stands overhead.
float photographers_azimuth(const Environment& environment);

/// What each pixel shows, taken apart: all as large as the picture, linear, means over the pixel's rays unless said.
/// Surroundings are in Picture::radiance alone: radiance - (direct + indirect + reflection) is what the pixel shows of
/// them.
struct PictureLayers {
    Image
        albedo; ///< 3: reflectance of what is seen, without its gloss; 0 where surroundings are seen or play the ground
    Image normal;     ///< 3: unit, in the world, on the side that is seen, relief in it; of the nearest of all; 0: none
    Image depth;      ///< 1: metres along the viewing axis to the nearest point; infinite where nothing is met
    Image direct;     ///< 3: scattered light of split-off lights that arrives unscattered
    Image indirect;   ///< 3: scattered light of all else, and of the air before far ground
    Image reflection; ///< 3: by gloss, of all light
    Image leaf;       ///< 1: number of the leaf (from 1) that most rays met; 0: none
};

struct Picture {
    Image radiance; ///< linear, 3 channels, finite, not negative
    Image subject;  ///< 1: the share of each pixel's rays that met surfaces, neither ground nor surroundings
    std::optional<PictureLayers> layers; ///< if asked for
    WorkReport report;                   ///< stages, counts (rays), skips
};

/// The ground is lit per pixel: lights shadow-tested, sky and light from the tree gathered over the hemisphere at the
/// nodes of a grid that is finer near the tree, and interpolated. The same bits for any number of threads. Throws
/// InputError if sizes disagree, Stopped if the user stopped.
Picture render_picture(const ShadedScene& scene, const RayQueries& queries, const Environment& environment,
                       const Camera& camera, const PictureOptions& options, Progress& progress);

/// The exposure that tone_map chooses by itself, in stops: radiance x 2^stops is what the curve sees. 0 for a black
/// picture. Metered like a camera, the middle of the picture counting most: the geometric mean of luminance goes to
/// middle grey (0.18) plus a quarter of a stop, because crowns are darker than a grey card. Where that would take the
/// level that 93 % stay below beyond 1.1, only 0.35 of the excess (in stops) is given, so that skies keep their colour
/// and trees against the light don't become silhouettes. What is brighter than that level, or 4.5 stops darker
/// (background, deep shade), is not in the mean. Pixels of the `subject` (as render_picture gives it; may be null) have
/// at least half of the say in the mean, so that a slender tree is not lost against the sky; where such a subject is
/// pale (a bare birch) and the level stays below 1.1, half of that room (in stops) is used, so that the sky is not
/// dull.
float automatic_exposure_stops(const Image& radiance, const Image* subject = nullptr);

/// Display-ready sRGB (as 0..1 floats) from linear radiance: exposure (automatic_exposure_stops if empty), then the
/// filmic curve of Uchimura ("HDR theory and practice", CEDEC 2017: P = 1, a = 1, m = 0.22, l = 0.4, c = 1.33, b = 0)
/// on every channel, then the sRGB curve. Any input gives finite output: NaN and negative values are black, infinity is
/// white.
Image tone_map(const Image& radiance, std::optional<float> exposure_stops, const Image* subject = nullptr);

} // namespace kokage
