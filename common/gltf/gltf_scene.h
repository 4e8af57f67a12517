#pragma once
// A glTF file's default scene, flattened: meshes in world space with their materials and decoded textures.
#include "common/gltf/gltf_document.h"
#include "common/scene/alpha_mask.h"
#include "common/scene/image.h"

#include <map>
#include <optional>

namespace kokage {

struct GltfTexture {
    std::shared_ptr<const Image> color; ///< linear RGB, 3 channels
    std::shared_ptr<const Image> alpha; ///< 1 channel; null where the image has none or is opaque all over
    TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;
    /// KHR_texture_transform: uv' = offset + R(rotation) (scale * uv), and the set of texture coordinates.
    glm::vec2 offset{0.f}, scale{1.f};
    float rotation = 0;
    int texture_coordinates = 0;
};

enum class GltfAlphaMode { opaque, mask, blend };

struct GltfMaterial {
    std::string name;
    glm::vec4 base_color{1.f}; ///< linear, alpha last
    std::optional<GltfTexture> base_color_texture;
    GltfAlphaMode alpha_mode = GltfAlphaMode::opaque;
    float alpha_cutoff = 0.5f;
    bool double_sided = false;
    bool unlit = false;
    float roughness = 1.f;
    std::optional<float> diffuse_transmission; ///< KHR_materials_diffuse_transmission
    glm::vec3 diffuse_transmission_color{1.f};
    float transmission = 0; ///< KHR_materials_transmission: clear, not diffuse
};

/// One triangle primitive in one place of the scene. Triangles' counter-clockwise side is the front, also under
/// mirroring nodes.
struct GltfMesh {
    std::string name; ///< of the node, or of the mesh
    std::string mesh_name;
    int mesh_index = 0, primitive_index = 0; ///< in the file
    int material = 0;                        ///< index in GltfScene::materials
    std::vector<glm::vec3> positions;        ///< relative to GltfScene::origin
    std::vector<glm::vec3> normals;          ///< unit; computed from the triangles where the file has none
    std::vector<glm::vec2> uvs;    ///< as the base colour texture is read, KHR_texture_transform applied; may be empty
    std::vector<glm::vec4> colors; ///< COLOR_0, linear; may be empty
    std::vector<glm::uvec3> triangles;
    std::map<std::string, int> custom_attributes; ///< names that begin with '_' -> accessor, one element a vertex
};

struct GltfScene {
    glm::dvec3 origin{0.0}; ///< to add to positions; not 0 only for a scene that lies far from the file's origin
    std::vector<GltfMaterial> materials;
    std::vector<GltfMesh> meshes;
    std::vector<std::string> notes; ///< what was left out
};

/// Flattens the default scene (else the first with meshes, else all root nodes). Transforms are multiplied in double
/// precision. `origin`: taken as it is where given; else 0 unless the scene lies farther from it than 16 times its
/// size. Throws InputError for indices out of range, numbers that are not finite, node cycles, and images that can't be
/// decoded.
GltfScene flatten(const GltfDocument& document, std::optional<glm::dvec3> origin = std::nullopt,
                  Progress& progress = silent_progress());

/// Area-weighted normals of a mesh; (0, 1, 0) at vertices without area.
std::vector<glm::vec3> compute_normals(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles);

} // namespace kokage
