#pragma once
// What a file of another program holds, flattened: meshes in world space with their materials and decoded textures.
// Read from glTF by common/gltf/gltf_scene.h, from OBJ by common/obj/obj_scene.h.
#include "common/scene/alpha_mask.h"
#include "common/scene/image.h"
#include "common/types.h"

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace kokage {

struct SceneTexture {
    std::shared_ptr<const Image> color; ///< linear RGB, 3 channels
    std::shared_ptr<const Image> alpha; ///< 1 channel; null where the image has none or is opaque all over
    TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;
    /// KHR_texture_transform: uv' = offset + R(rotation) (scale * uv), and the set of texture coordinates.
    glm::vec2 offset{0.f}, scale{1.f};
    float rotation = 0;
    int texture_coordinates = 0;
};

/// Whether two textures are read in the same coordinates in the same way.
bool lies_alike(const SceneTexture& a, const SceneTexture& b);

enum class AlphaMode { opaque, mask, blend };

struct SceneMaterial {
    std::string name;
    glm::vec4 base_color{1.f}; ///< linear, alpha last
    std::optional<SceneTexture> base_color_texture;
    /// The file has a colour texture that can't be had (its format, or the file itself): it says nothing of how the
    /// surface looks, and a stated substitute takes its place.
    bool color_is_lost = false;
    bool is_missing = false; ///< stands for surfaces that the file gives no material: a stated substitute as well
    AlphaMode alpha_mode = AlphaMode::opaque;
    float alpha_cutoff = 0.5f;
    bool double_sided = false;
    bool unlit = false;
    float roughness = 1.f, metallic = 0;
    float index_of_refraction = 1.5f; ///< KHR_materials_ior; 0: a metal's mirror whatever the angle
    /// Roughness in the second channel and metal in the third, times the factors; read where it is asked for.
    std::optional<SceneTexture> roughness_metallic_texture;
    /// Normals in the tangent frame, 0..1 for -1..1, green towards smaller v; read where it is asked for.
    std::optional<SceneTexture> normal_texture;
    float normal_scale = 1;                    ///< times their slopes
    std::optional<float> diffuse_transmission; ///< KHR_materials_diffuse_transmission
    glm::vec3 diffuse_transmission_color{1.f};
    float transmission = 0; ///< KHR_materials_transmission: clear, not diffuse
};

/// Triangles of one material in one place of the scene (instances of a node lie in one mesh, one after the other).
/// Triangles' counter-clockwise side is the front, also under mirroring nodes.
struct SceneMesh {
    std::string name; ///< of the node, or of the mesh
    std::string mesh_name;
    int mesh_index = 0, primitive_index = 0; ///< in the file
    int material = 0;                        ///< index in MeshScene::materials
    std::vector<glm::vec3> positions;        ///< relative to MeshScene::origin
    std::vector<glm::vec3> normals;          ///< unit; computed from the triangles where the file has none
    std::vector<glm::vec2> uvs;    ///< as the base colour texture is read, KHR_texture_transform applied; may be empty
    std::vector<glm::vec4> colors; ///< of vertices, linear; may be empty
    std::vector<glm::uvec3> triangles;
    /// glTF: names that begin with '_' -> accessor, one element a vertex; none for a mesh of several instances.
    std::map<std::string, int> custom_attributes;
};

/// The most vertices, and the most triangles, of a scene, what is repeated counted each time: readers refuse more
/// before they take memory for it. (A tree of a million leaves has a few million.)
inline constexpr std::size_t kMaximumSceneVertices = std::size_t(1) << 25;
inline constexpr std::size_t kMaximumSceneTriangles = std::size_t(1) << 25;

struct MeshScene {
    glm::dvec3 origin{0.0}; ///< to add to positions; not 0 only for a scene that lies far from the file's origin
    std::vector<SceneMaterial> materials;
    std::vector<SceneMesh> meshes;
    std::vector<std::string> notes; ///< what was left out or substituted
};

/// Area-weighted normals of a mesh; (0, 1, 0) at vertices without area.
std::vector<glm::vec3> compute_normals(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles);

/// Colour and alpha of an image as a texture holds them; alpha that is 1 everywhere is no alpha.
SceneTexture split_alpha(const Image& image);

/// Turned from +Z up to +Y up.
void set_upright(MeshScene& scene);

/// 0, unless a scene of this box lies so far away that floats would coarsen it: then its centre.
glm::dvec3 choose_origin(const glm::dvec3& low, const glm::dvec3& high);

} // namespace kokage
