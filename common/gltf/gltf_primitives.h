#pragma once
// A glTF primitive's arrays as the file stores them, and as morph targets and skins deform them. Private to
// common/gltf.
#include "common/gltf/gltf_nodes.h"
#include "common/scene/mesh_scene.h"

namespace tinygltf {
struct Primitive;
}

namespace kokage {

/// Cofactor matrix = determinant x inverse transpose, which also exists for flat scales: it turns normals.
inline glm::dmat3 cofactors(const glm::dmat3& m) {
    return glm::dmat3(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
}

struct GltfPrimitive {
    std::vector<glm::dvec3> positions;
    std::vector<glm::vec3> normals; ///< as long as positions, or empty; not yet of unit length
    std::vector<glm::vec2> uvs;     ///< as long as positions, or empty
    std::vector<glm::vec4> colors;
    std::vector<glm::uvec3> triangles;
    std::map<std::string, int> custom_attributes;
    int material = 0;
};

/// Triangles, strips and fans, with indices or without. The last of `materials` is for primitives that name none.
/// `place` is for messages. Throws InputError.
GltfPrimitive read_gltf_primitive(const GltfDocument& document, const tinygltf::Primitive& source,
                                  const std::vector<SceneMaterial>& materials, const std::string& place);

/// True if a node shows the primitive otherwise than the file stores it: with morph targets' weights that are not 0, or
/// with a skin.
bool is_deformed(const GltfDocument& document, int node, const tinygltf::Primitive& source);

/// The primitive with a node's morph targets added (weights of the node, else of its mesh) and its skin applied: then
/// positions are in the world, whatever the node's own transform (glTF 2.0, section 3.7.3.3). Throws InputError.
GltfPrimitive deformed(const GltfDocument& document, const GltfNodes& nodes, int node,
                       const tinygltf::Primitive& source, GltfPrimitive primitive, const std::string& place);

} // namespace kokage
