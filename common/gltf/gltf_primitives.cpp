#include "common/gltf/gltf_primitives.h"

#include "common/gltf/check_gltf.h"

#include <algorithm>
#include <cmath>
#include <tiny_gltf.h>

namespace kokage {
namespace {

int attribute(const std::map<std::string, int>& attributes, const std::string& name) {
    const auto found = attributes.find(name);
    return found == attributes.end() ? -1 : found->second;
}

std::vector<glm::uvec3> read_triangles(const GltfDocument& document, const tinygltf::Primitive& primitive,
                                       std::size_t vertices, const std::string& place) {
    std::vector<std::uint32_t> indices;
    if (primitive.indices >= 0) {
        indices = document.unsigned_integers(primitive.indices);
    } else {
        indices.resize(vertices);
        for (std::size_t i = 0; i < vertices; ++i)
            indices[i] = std::uint32_t(i);
    }
    for (std::size_t i = 0; i < indices.size(); ++i)
        if (indices[i] >= vertices)
            document.fail(place + ": index " + std::to_string(i) + " names vertex " + std::to_string(indices[i]) +
                          " of " + std::to_string(vertices));
    if (primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN)
        document.fail(place + ": mode " + std::to_string(primitive.mode) + " is not one of glTF's (0 to 6)");
    std::vector<glm::uvec3> triangles;
    const std::size_t count = indices.size();
    if (primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
        for (std::size_t i = 2; i < count; ++i)
            triangles.push_back(i % 2 == 0 ? glm::uvec3(indices[i - 2], indices[i - 1], indices[i])
                                           : glm::uvec3(indices[i - 1], indices[i - 2], indices[i]));
    } else if (primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN) {
        for (std::size_t i = 2; i < count; ++i)
            triangles.emplace_back(indices[0], indices[i - 1], indices[i]);
    } else {
        triangles.reserve(count / 3);
        for (std::size_t i = 0; i + 2 < count; i += 3)
            triangles.emplace_back(indices[i], indices[i + 1], indices[i + 2]);
    }
    return triangles;
}

std::vector<glm::vec3> vectors(const std::vector<float>& values) {
    std::vector<glm::vec3> result(values.size() / 3);
    for (std::size_t i = 0; i < result.size(); ++i)
        result[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
    return result;
}

std::vector<glm::vec4> read_colors(const GltfDocument& document, int accessor_index) {
    const tinygltf::Accessor& accessor = document.model().accessors[std::size_t(accessor_index)];
    const std::size_t components = accessor.type == TINYGLTF_TYPE_VEC4 ? 4 : 3;
    const std::vector<float> values = document.floats(accessor_index, int(components));
    // Integers that a file forgot to call normalised can't be meant as they are.
    const float top = accessor.normalized                                                ? 1.f
                      : accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE  ? 255.f
                      : accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ? 65535.f
                                                                                         : 1.f;
    std::vector<glm::vec4> colors(values.size() / components, glm::vec4(1.f));
    for (std::size_t i = 0; i < colors.size(); ++i)
        for (std::size_t c = 0; c < components; ++c)
            colors[i][c] = values[i * components + c] / top;
    return colors;
}

std::vector<glm::vec2> read_uvs(const GltfDocument& document, int accessor) {
    const std::vector<float> values = document.floats(accessor, 2);
    std::vector<glm::vec2> uvs(values.size() / 2);
    for (std::size_t i = 0; i < uvs.size(); ++i) {
        uvs[i] = {values[2 * i], values[2 * i + 1]};
        if (!std::isfinite(uvs[i].x) || !std::isfinite(uvs[i].y))
            uvs[i] = glm::vec2(0.f);
    }
    return uvs;
}

void check_positions(const GltfDocument& document, const std::vector<glm::dvec3>& positions, const std::string& place) {
    for (std::size_t i = 0; i < positions.size(); ++i)
        if (!std::isfinite(positions[i].x) || !std::isfinite(positions[i].y) || !std::isfinite(positions[i].z))
            document.fail(place + ": vertex " + std::to_string(i) + " is not finite");
}

const std::vector<double>& morph_weights(const tinygltf::Model& model, int node_index) {
    const tinygltf::Node& node = model.nodes[std::size_t(node_index)];
    return node.weights.empty() ? model.meshes[std::size_t(node.mesh)].weights : node.weights;
}

void apply_morphs(const GltfDocument& document, const std::vector<double>& weights, const tinygltf::Primitive& source,
                  GltfPrimitive& primitive, const std::string& place) {
    for (std::size_t t = 0; t < source.targets.size() && t < weights.size(); ++t) {
        if (weights[t] == 0)
            continue;
        const auto deltas = [&](const char* name) {
            const int accessor = attribute(source.targets[t], name);
            if (accessor < 0)
                return std::vector<glm::vec3>();
            std::vector<glm::vec3> values = vectors(document.floats(accessor, 3));
            if (values.size() != primitive.positions.size())
                document.fail(place + ": morph target " + std::to_string(t) + " has " + std::to_string(values.size()) +
                              " elements for " + std::to_string(primitive.positions.size()) + " vertices");
            return values;
        };
        const std::vector<glm::vec3> positions = deltas("POSITION"), normals = deltas("NORMAL");
        for (std::size_t i = 0; i < positions.size(); ++i)
            primitive.positions[i] += weights[t] * glm::dvec3(positions[i]);
        for (std::size_t i = 0; i < normals.size() && i < primitive.normals.size(); ++i)
            primitive.normals[i] += float(weights[t]) * normals[i];
    }
}

/// Each joint's transform from the mesh's space to the world: its node's times its inverse bind matrix.
std::vector<glm::dmat4> joint_matrices(const GltfDocument& document, const GltfNodes& nodes, int skin_index) {
    const auto& model = document.model();
    const std::string place = "skin " + std::to_string(skin_index);
    if (skin_index < 0 || std::size_t(skin_index) >= model.skins.size())
        document.fail(place + " does not exist");
    const tinygltf::Skin& skin = model.skins[std::size_t(skin_index)];
    std::vector<float> inverse;
    if (skin.inverseBindMatrices >= 0)
        inverse = document.floats(skin.inverseBindMatrices, 16);
    if (skin.inverseBindMatrices >= 0 && inverse.size() < 16 * skin.joints.size())
        document.fail(place + " has " + std::to_string(skin.joints.size()) + " joints, but " +
                      std::to_string(inverse.size() / 16) + " inverse bind matrices");
    std::vector<glm::dmat4> matrices;
    for (std::size_t j = 0; j < skin.joints.size(); ++j) {
        if (skin.joints[j] < 0 || std::size_t(skin.joints[j]) >= model.nodes.size())
            document.fail(place + ": node " + std::to_string(skin.joints[j]) + " does not exist");
        glm::dmat4 bind(1.0);
        for (std::size_t i = 0; i < 16 && !inverse.empty(); ++i)
            bind[i / 4][i % 4] = inverse[16 * j + i];
        matrices.push_back(nodes.world(skin.joints[j]) * bind);
    }
    return matrices;
}

void apply_skin(const GltfDocument& document, const std::vector<glm::dmat4>& joints, const tinygltf::Primitive& source,
                GltfPrimitive& primitive, const std::string& place) {
    std::vector<std::vector<float>> indices, weights;
    for (int set = 0; set < 4; ++set) {
        const int joint_accessor = attribute(source.attributes, "JOINTS_" + std::to_string(set));
        const int weight_accessor = attribute(source.attributes, "WEIGHTS_" + std::to_string(set));
        if (joint_accessor < 0 || weight_accessor < 0)
            break;
        indices.push_back(document.floats(joint_accessor, 4));
        weights.push_back(document.floats(weight_accessor, 4));
    }
    for (std::size_t v = 0; v < primitive.positions.size(); ++v) {
        glm::dmat4 blended(0.0);
        double sum = 0;
        for (std::size_t set = 0; set < indices.size(); ++set)
            for (std::size_t i = 4 * v; i < 4 * v + 4; ++i) {
                const float index = indices[set][i], weight = weights[set][i];
                if (!(weight > 0) || !std::isfinite(weight))
                    continue;
                if (!(index >= 0) || !(index < float(joints.size())))
                    document.fail(place + ": vertex " + std::to_string(v) + " hangs on joint " + std::to_string(index) +
                                  " of " + std::to_string(joints.size()));
                blended += double(weight) * joints[std::size_t(index)];
                sum += double(weight);
            }
        // A vertex on no joint would fall into the origin: it follows the first.
        const glm::dmat4 matrix = sum > 0 ? blended / sum : joints.front();
        primitive.positions[v] = glm::dvec3(matrix * glm::dvec4(primitive.positions[v], 1.0));
        if (!primitive.normals.empty())
            primitive.normals[v] = glm::vec3(cofactors(glm::dmat3(matrix)) * glm::dvec3(primitive.normals[v]));
    }
}

} // namespace

GltfPrimitive read_gltf_primitive(const GltfDocument& document, const tinygltf::Primitive& source,
                                  const std::vector<SceneMaterial>& materials, const std::string& place) {
    GltfPrimitive primitive;
    const int position = attribute(source.attributes, "POSITION");
    if (position < 0)
        document.fail(place + " has no POSITION");
    const std::size_t vertices = document.accessor_count(position);
    for (const auto& [name, accessor] : source.attributes)
        if (document.accessor_count(accessor) != vertices)
            document.fail(place + ": " + name + " has " + std::to_string(document.accessor_count(accessor)) +
                          " elements for " + std::to_string(vertices) + " vertices");
    if (source.material >= 0 && std::size_t(source.material) + 1 >= materials.size())
        document.fail(place + ": material " + std::to_string(source.material) + " does not exist");
    primitive.material = source.material >= 0 ? source.material : int(materials.size()) - 1;
    const std::vector<glm::vec3> positions = vectors(document.floats(position, 3));
    primitive.positions.assign(positions.begin(), positions.end());
    check_positions(document, primitive.positions, place);
    if (const int normal = attribute(source.attributes, "NORMAL"); normal >= 0)
        primitive.normals = vectors(document.floats(normal, 3));
    const auto& texture = materials[std::size_t(primitive.material)].base_color_texture;
    const int set = texture ? texture->texture_coordinates : 0;
    if (const int uv = attribute(source.attributes, "TEXCOORD_" + std::to_string(set)); uv >= 0)
        primitive.uvs = read_uvs(document, uv);
    if (const int color = attribute(source.attributes, "COLOR_0"); color >= 0)
        primitive.colors = read_colors(document, color);
    for (const auto& [name, accessor] : source.attributes)
        if (name.starts_with('_'))
            primitive.custom_attributes[name] = accessor;
    primitive.triangles = read_triangles(document, source, vertices, place);
    return primitive;
}

bool is_deformed(const GltfDocument& document, int node_index, const tinygltf::Primitive& source) {
    const tinygltf::Model& model = document.model();
    if (model.nodes[std::size_t(node_index)].skin >= 0 && attribute(source.attributes, "JOINTS_0") >= 0 &&
        attribute(source.attributes, "WEIGHTS_0") >= 0)
        return true;
    const std::vector<double>& weights = morph_weights(model, node_index);
    return !source.targets.empty() && std::any_of(weights.begin(), weights.end(), [](double w) { return w != 0; });
}

GltfPrimitive deformed(const GltfDocument& document, const GltfNodes& nodes, int node_index,
                       const tinygltf::Primitive& source, GltfPrimitive primitive, const std::string& place) {
    const tinygltf::Model& model = document.model();
    apply_morphs(document, morph_weights(model, node_index), source, primitive, place);
    const int skin = model.nodes[std::size_t(node_index)].skin;
    if (skin >= 0 && attribute(source.attributes, "JOINTS_0") >= 0 && attribute(source.attributes, "WEIGHTS_0") >= 0) {
        const std::vector<glm::dmat4> joints = joint_matrices(document, nodes, skin);
        if (joints.empty())
            document.fail("skin " + std::to_string(skin) + " has no joints");
        apply_skin(document, joints, source, primitive, place);
    }
    check_positions(document, primitive.positions, place);
    return primitive;
}

} // namespace kokage
