#include "reflection/scene_relief.h"
#include "common/services/count_text.h"
#include "common/services/error.h"
#include "common/services/random.h"
#include "common/services/stopwatch.h"
#include "reflection/view_frustum.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <unordered_set>
#include <utility>

namespace kokage {
namespace {

constexpr float kLeastPixels = 0.25f; ///< relief_strength is 0 up to here
constexpr int kAzimuths = 24;         ///< of openness: 0.01 off at worst, as between texels

struct PlaceHash {
    std::size_t operator()(const glm::vec3& p) const {
        std::array<std::uint32_t, 3> bits;
        std::memcpy(bits.data(), &p, sizeof(bits));
        return hash64(hash64(hash64(bits[0]) + bits[1]) + bits[2]);
    }
};

std::string number(const char* format, double value) {
    std::array<char, 64> text;
    std::snprintf(text.data(), text.size(), format, value);
    return text.data();
}

bool has_relief(const SurfaceLook& look) {
    return look.relief.heights && look.relief.depth_m > 0;
}

void check(const ShadedScene& scene) {
    const PatchScene& patches = *scene.patches;
    for (const SurfaceLook& look : scene.looks) {
        if (!look.relief.heights)
            continue;
        const LookRelief& relief = look.relief;
        if (relief.heights->depths.empty() || !(relief.depth_m >= 0) || !std::isfinite(relief.depth_m) ||
            !(relief.tile_m >= 0) || !std::isfinite(relief.tile_m))
            throw InputError("picture: a look's relief has " + std::to_string(relief.heights->depths.size()) +
                             " heights, " + std::to_string(relief.depth_m) + " m deep on tiles of " +
                             std::to_string(relief.tile_m) + " m; it needs heights, and finite sizes of at least 0");
        if (patches.uvs.empty() || scene.normals.empty())
            throw InputError("picture: relief needs texture coordinates and normals, which the scene has not");
    }
}

/// Which of the scene's triangles a camera may see with relief.
class TrianglesInView {
  public:
    TrianglesInView(const ShadedScene& scene, const CameraFrame& frame)
        : scene_(scene), position_(frame.position), view_(frame), pixel_(pixel_size(frame)) {}

    /// 0: another material, or out of view; else the most pixels that its depth may cover.
    float pixels(std::size_t triangle) const {
        const SurfaceLook& look = scene_.looks[scene_.triangle_look[triangle]];
        if (!has_relief(look))
            return 0;
        const PatchScene& patches = *scene_.patches;
        const glm::uvec3 corners = patches.triangles[triangle];
        const glm::vec3 centre =
            (patches.positions[corners.x] + patches.positions[corners.y] + patches.positions[corners.z]) / 3.f;
        float radius = 0;
        for (int k = 0; k < 3; ++k)
            radius = std::max(radius, glm::distance(centre, patches.positions[corners[k]]));
        if (!view_.may_see(centre, radius + 4 * look.relief.depth_m))
            return 0;
        const float distance = glm::distance(centre, position_) - radius;
        return look.relief.depth_m / std::max(distance * pixel_, 1e-30f);
    }

  private:
    const ShadedScene& scene_;
    const glm::vec3 position_;
    const ViewFrustum view_;
    float pixel_;
};

/// The triangles of the shell: those in view, and bark around them.
struct Choice {
    std::vector<std::uint32_t> triangles;
    std::size_t solid = 0;             ///< of them
    float most_pixels = 0;             ///< over all in view, whether chosen or not
    std::size_t in_view = 0, thin = 0; ///< of these, less than what is seen
};

Choice choose(const ShadedScene& scene, const CameraFrame& frame, float least_pixels) {
    const PatchScene& patches = *scene.patches;
    const TrianglesInView view(scene, frame);
    Choice choice;
    std::vector<bool> chosen(patches.triangles.size());
    std::unordered_set<glm::vec3, PlaceHash> places;
    for (std::size_t t = 0; t < patches.triangles.size(); ++t) {
        const float pixels = view.pixels(t);
        choice.in_view += pixels > 0;
        choice.most_pixels = std::max(choice.most_pixels, pixels);
        chosen[t] = pixels > least_pixels;
        choice.thin += pixels > 0 && !chosen[t];
        for (int k = 0; k < 3 && chosen[t]; ++k)
            places.insert(patches.positions[patches.triangles[t][k]]);
    }
    if (places.empty())
        return choice;
    for (std::size_t t = 0; t < patches.triangles.size(); ++t) {
        bool adjoins = false;
        if (!chosen[t] && patches.patches[patches.triangle_patch[t]].kind == PatchKind::bark)
            for (int k = 0; k < 3 && !adjoins; ++k)
                adjoins = places.contains(patches.positions[patches.triangles[t][k]]);
        choice.solid += adjoins;
        if (chosen[t] || adjoins)
            choice.triangles.push_back(std::uint32_t(t));
    }
    return choice;
}

/// The scene's arrays cut down to the chosen triangles.
struct MeshPart {
    std::vector<glm::vec3> positions, normals;
    std::vector<glm::vec2> uvs;
    std::vector<glm::uvec3> triangles;

    MeshPart(const ShadedScene& scene, const std::vector<std::uint32_t>& chosen) {
        const PatchScene& patches = *scene.patches;
        std::vector<std::uint32_t> index(patches.positions.size(), SceneRelief::kNone);
        for (const std::uint32_t t : chosen) {
            glm::uvec3 triangle;
            for (int k = 0; k < 3; ++k) {
                const std::uint32_t vertex = patches.triangles[t][k];
                if (index[vertex] == SceneRelief::kNone) {
                    index[vertex] = std::uint32_t(positions.size());
                    positions.push_back(patches.positions[vertex]);
                    normals.push_back(scene.normals[vertex]);
                    uvs.push_back(patches.uvs[vertex]);
                }
                triangle[k] = index[vertex];
            }
            triangles.push_back(triangle);
        }
    }
    ReliefMesh mesh() const { return {positions, normals, uvs, triangles}; }
};

bool same(const LookRelief& a, const LookRelief& b) {
    return a.heights == b.heights && a.depth_m == b.depth_m && a.tile_m == b.tile_m;
}

/// The layers of the chosen triangles; `reliefs`: of layers 1, 2, ...
ReliefLayers find_layers(const ShadedScene& scene, const CameraFrame& frame, const Choice& choice, float least_pixels,
                         std::vector<LookRelief>& reliefs) {
    const TrianglesInView view(scene, frame);
    ReliefLayers layers;
    layers.depths.push_back({0, 0, 0});
    for (const std::uint32_t t : choice.triangles) {
        if (!(view.pixels(t) > least_pixels)) {
            layers.of_triangle.push_back(0);
            continue;
        }
        const LookRelief& relief = scene.looks[scene.triangle_look[t]].relief;
        auto found =
            std::find_if(reliefs.begin(), reliefs.end(), [&](const LookRelief& known) { return same(known, relief); });
        if (found == reliefs.end()) {
            if (reliefs.size() == 255)
                throw InputError("picture: more than 255 different reliefs are in view; share height maps and depths");
            found = reliefs.insert(found, relief);
            layers.depths.push_back({relief.depth_m, relief.tile_m, ReliefDepth().most_of_radius});
        }
        layers.of_triangle.push_back(std::uint8_t(found - reliefs.begin() + 1));
    }
    return layers;
}

/// Mean size of the tiles of a layer, for reliefs that do not tell the size of theirs; 0 if there are no tiles.
float mean_tile(const ReliefMesh& mesh, const ReliefLayers& layers, std::size_t layer) {
    const WeldedPlaces places = weld_places(mesh.positions);
    const std::vector<float> sizes = tile_sizes(mesh, places);
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (int k = 0; k < 3 && layers.of_triangle[t] == layer; ++k)
            if (const float size = sizes[places.place_of_vertex[mesh.triangles[t][k]]]; size > 0) {
                sum += double(size);
                ++count;
            }
    return count > 0 ? float(sum / double(count)) : 0;
}

ReliefMap make_map(const LookRelief& relief, float tile_m, Progress& progress) {
    ReliefMap map;
    map.tracer = make_exact_tracer(*relief.heights);
    OpennessSettings settings;
    settings.scale = {glm::vec2(tile_m > 0 ? tile_m : 1), tile_m > 0 ? relief.depth_m : 0};
    settings.azimuths = kAzimuths;
    map.openness = horizon_openness(*relief.heights, settings, progress);
    return map;
}

} // namespace

std::size_t SceneRelief::bytes() const {
    std::size_t sum = shell.bytes() + frames.frames.size() * sizeof(TangentFrame) +
                      frames.corners.size() * sizeof(glm::uvec3) +
                      (scene_triangle.size() + prism.size()) * sizeof(std::uint32_t);
    for (const ReliefMap& map : maps)
        sum += map.tracer->bytes() + map.openness.bytes();
    return sum;
}

std::unique_ptr<SceneRelief> make_scene_relief(const ShadedScene& scene, const CameraFrame& frame, bool skip_thin,
                                               Progress& progress, WorkReport& report) {
    check(scene);
    const auto wearers = std::count_if(scene.looks.begin(), scene.looks.end(), has_relief);
    if (wearers == 0) {
        report.skips.push_back({"relief", "no material in the scene has any", "a shell below the surfaces in view"});
        return nullptr;
    }
    const Stopwatch watch;
    const float least_pixels = skip_thin ? kLeastPixels : 0;
    const Choice choice = choose(scene, frame, least_pixels);
    if (choice.triangles.empty()) {
        const std::string cost = "a shell below surfaces in view (about 1 s CPU and 70 MB a million triangles), bounds "
                                 "and openness of " +
                                 std::to_string(wearers) +
                                 " materials' heights, and a second ray into each pixel of "
                                 "them";
        report.skips.push_back({"relief",
                                choice.in_view == 0 ? "no surface with relief is in view"
                                                    : "its depth covers " + number("%.2g", double(choice.most_pixels)) +
                                                          " of a pixel at most; a quarter is the least that is seen",
                                cost});
        return nullptr;
    }
    if (choice.thin > 0)
        report.skips.push_back(
            {"relief of " + count_text(choice.thin) + " of " + count_text(choice.in_view) + " triangles in view",
             "its depth covers less than a quarter of a pixel there",
             "their part of the shell, and a second ray into each pixel of them"});
    progress.begin("preparing relief", 1);
    auto result = std::make_unique<SceneRelief>();
    const MeshPart part(scene, choice.triangles);
    std::vector<LookRelief> reliefs;
    const ReliefLayers layers = find_layers(scene, frame, choice, least_pixels, reliefs);
    result->shell = make_relief_shell(part.mesh(), layers, "picture");
    result->frames = make_tangent_frames(part.mesh());
    std::vector<SurfaceReliefLayer> traced(1);
    for (std::size_t k = 0; k < reliefs.size(); ++k) {
        const float tile = reliefs[k].tile_m > 0 ? reliefs[k].tile_m : mean_tile(part.mesh(), layers, k + 1);
        result->maps.push_back(make_map(reliefs[k], tile, progress));
        const std::vector<float>& depths = reliefs[k].heights->depths;
        traced.push_back({result->maps.back().tracer.get(), *std::min_element(depths.begin(), depths.end())});
    }
    result->scene_triangle = choice.triangles;
    result->prism.assign(scene.patches->triangles.size(), SceneRelief::kNone);
    for (std::size_t p = 0; p < choice.triangles.size(); ++p)
        result->prism[choice.triangles[p]] = std::uint32_t(p);
    result->surface = std::make_unique<SurfaceRelief>(result->shell, result->frames, std::move(traced));
    report.stages.push_back({"preparing relief", watch.cpu(), watch.wall()});
    report.counts.push_back({"triangles with relief", choice.triangles.size() - choice.solid});
    report.counts.push_back({"bytes for relief", result->bytes()});
    return result;
}

} // namespace kokage
