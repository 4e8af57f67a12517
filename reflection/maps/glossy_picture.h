#pragma once
// Pictures of glossy objects in surroundings at infinity: the truth of [R] eqs 1 and 2, pixel by pixel, and the same
// from a map. Both are divided by the lobe's full mass, 2π/(Λ+1) for Phong, also where the horizon clips it; K_r = 1.
#include "reflection/maps/horizon.h"
#include "reflection/picture.h"

#include "common/scene/mesh_scene.h"

#include <functional>
#include <span>

namespace kokage {

/// What reflects: triangles and smooth normals.
struct GlossyObject {
    PatchScene patches;             ///< one patch
    std::vector<glm::vec3> normals; ///< per position
};

/// All meshes of a scene as one object. `z_up`: turned from +Z up to +Y up (x, y, z -> x, z, -y).
GlossyObject glossy_object(const MeshScene& scene, bool z_up);

/// What a camera sees of an object: covered pixels only, in raster order. At its rim a smoothed normal may look away
/// from the camera; the mirrored direction then lies below the horizon, and eq 2 leaves little or nothing of the lobe.
struct SurfacePixels {
    int width = 0, height = 0;        ///< of the picture
    std::vector<std::uint32_t> pixel; ///< y width + x
    std::vector<std::uint32_t> triangle;
    std::vector<glm::vec2> barycentric; ///< weights of the triangle's corners 1 and 2
    std::vector<glm::vec3> position;
    std::vector<glm::vec3> normal;   ///< interpolated, unit
    std::vector<glm::vec3> mirrored; ///< the view direction mirrored by it: r = 2 (n·v) n - v
    std::size_t size() const { return pixel.size(); }
};

/// One ray through the centre of every pixel.
SurfacePixels surface_in_view(const GlossyObject& object, const Camera& camera, int width, int height);

/// Per pixel, from values per position of the object: linear over each triangle.
template <typename Value>
std::vector<Value> interpolated(const GlossyObject& object, const SurfacePixels& pixels,
                                std::span<const Value> values) {
    std::vector<Value> result(pixels.size());
    for (std::size_t i = 0; i < result.size(); ++i) {
        const glm::uvec3 corner = object.patches.triangles[pixels.triangle[i]];
        const glm::vec2 b = pixels.barycentric[i];
        result[i] = (1 - b.x - b.y) * values[corner[0]] + b.x * values[corner[1]] + b.y * values[corner[2]];
    }
    return result;
}

/// [R] eqs 1 and 2 with the horizon's test: per pixel, the sum over every pixel of the lat-long image with its solid
/// angle and its share above the horizon, in double. `parameters`: Λ or roughness of each pixel. Throws Stopped.
std::vector<glm::vec3> reflected_by_brute_force(const SurfacePixels& pixels, LobeKind kind,
                                                std::span<const float> parameters, const Image& surroundings,
                                                Progress& progress = silent_progress());

/// A map, whatever it is made of: radiance in a direction through a lobe. Called from several threads.
using MapLookup = std::function<glm::vec3(const glm::vec3& direction, float parameter)>;

/// Per pixel, from a map, with the table's horizon correction.
std::vector<glm::vec3> reflected_from_map(const SurfacePixels& pixels, std::span<const float> parameters,
                                          const MapLookup& look_up, const HorizonTable& horizon);

/// The picture: `values` where the surface is, `background` elsewhere.
Image picture_of(const SurfacePixels& pixels, std::span<const glm::vec3> values,
                 const glm::vec3& background = glm::vec3(0.f));

} // namespace kokage
