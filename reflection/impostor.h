#pragma once
// A scene seen from afar as a few flat cards: views of it, and cards that show them.
#include "common/environment/environment.h"
#include "common/services/progress.h"
#include "reflection/picture.h"

#include <filesystem>
#include <vector>

namespace kokage {

/// What a view shows: an upright rectangle, seen in parallel projection.
struct ViewFrame {
    glm::vec3 centre{0.f};
    glm::vec3 towards_viewer{0, 0, 1}; ///< unit, level
    float half_width = 1, half_height = 1;
    glm::vec3 right() const { return glm::normalize(glm::cross(glm::vec3(0, 1, 0), towards_viewer)); }
};

/// One view, without what is behind: means over the samples that hit.
struct CapturedView {
    Image color;  ///< linear radiance, 3 channels; where nothing was hit, what is nearest
    Image alpha;  ///< share of the samples that hit, 1 channel
    Image normal; ///< mean unit normal of the seen side, world space, 3 channels; likewise filled
};

/// Mean of an alpha channel: the share of a view that shows the scene.
double coverage(const Image& alpha);

/// The solved radiance of the scene (no light is tested again) as the frame shows it, `samples` rays a pixel. The
/// scene's ground is left out. The same bits with any number of threads. Throws InputError for sizes below 1, Stopped.
CapturedView capture_view(const ShadedScene& scene, const RayQueries& queries, const Environment& environment,
                          const ViewFrame& frame, int width, int height, int samples, Progress& progress);

/// Upright cards through the scene's middle, each with the view from its front and another from its back, in one atlas:
///
///      2 cards from above:   \ | /      atlas, 2 cards:   | front 0 | back 0 |
///                           ---+---                       | front 1 | back 1 |
///
struct Impostor {
    std::vector<ViewFrame> faces; ///< two a card: front, back; face f has column f % 2, row f / 2 of the atlas
    Image color, alpha, normal;   ///< the atlas; normals in the card's frame: x right, y up, z to the viewer
    float alpha_cutoff = 0.5f;    ///< such that the cards together cover about what the scene does
    float scale = 1;              ///< the colour that a file stores as 1: the 99th percentile of solid texels
};

/// Cards at azimuths spread evenly from `azimuth` on (radians from +Z towards +X), `size` texels high each.
/// Throws InputError unless 1 <= cards <= 16 and 8 <= size <= 4096.
Impostor make_impostor(const ShadedScene& scene, const RayQueries& queries, const Environment& environment, int cards,
                       int size, float azimuth, Progress& progress);

/// The cards as a scene that render_picture and capture_view draw: radiance is in the texture.
struct ImpostorScene {
    PatchScene patches;
    ShadedScene shaded; ///< points to `patches`
};
void make_impostor_scene(const Impostor& impostor, ImpostorScene& scene);

/// Writes it as .glb, whole or not at all: KHR_materials_unlit, colour / scale with alpha mask, single-sided cards with
/// tangents, a normal texture for hosts that light cards themselves. `extras.kokage_impostor` holds the scale and the
/// cards' azimuths.
void write_impostor(const std::filesystem::path& path, const Impostor& impostor, const std::string& name);

/// Bounds of what a camera sees of a scene: of all triangles, ground aside.
ViewFrame frame_of(const PatchScene& scene, float azimuth);

} // namespace kokage
