#include "common/gltf/gltf_scene.h"

#include "common/gltf/gltf_materials.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <tiny_gltf.h>

namespace kokage {
namespace {

constexpr std::size_t kMaximumVertices = std::size_t(1) << 27;

/// A mesh of the file in a place of the scene.
struct Instance {
    int mesh = 0;
    int node = 0;
    glm::dmat4 transform{1.0};
};

glm::dmat4 local_transform(const GltfDocument& document, int index) {
    const tinygltf::Node& node = document.model().nodes[std::size_t(index)];
    glm::dmat4 result(1.0);
    if (node.matrix.size() == 16) {
        for (std::size_t i = 0; i < 16; ++i)
            result[i / 4][i % 4] = node.matrix[i];
    } else {
        if (node.scale.size() == 3)
            for (std::size_t c = 0; c < 3; ++c)
                result[c][c] = node.scale[c];
        if (node.rotation.size() == 4) {
            const glm::dquat rotation(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
            if (glm::length(rotation) > 0)
                result = glm::mat4_cast(glm::normalize(rotation)) * result;
        }
        if (node.translation.size() == 3)
            result[3] = glm::dvec4(node.translation[0], node.translation[1], node.translation[2], 1.0);
    }
    for (std::size_t i = 0; i < 16; ++i)
        if (!std::isfinite(result[i / 4][i % 4]))
            document.fail("node " + std::to_string(index) + " has a transform that is not finite");
    return result;
}

/// Walks nodes without recursion, so that a deep chain can't exhaust the stack. Nodes form trees, or an error is
/// thrown.
class SceneWalk {
  public:
    explicit SceneWalk(const GltfDocument& document) : document_(document), parent_(document.model().nodes.size(), -1) {
        const auto& nodes = document.model().nodes;
        for (std::size_t i = 0; i < nodes.size(); ++i)
            for (const int child : nodes[i].children) {
                check_node(child, "node " + std::to_string(i));
                if (parent_[std::size_t(child)] >= 0 || child == int(i))
                    document.fail("node " + std::to_string(child) + " is a child of two nodes, or of itself");
                parent_[std::size_t(child)] = int(i);
            }
        order_nodes();
    }

    /// The nodes of the default scene. Some exporters list a child among a scene's roots, and sometimes its parent as
    /// well.
    std::vector<int> roots(std::vector<std::string>& notes) const {
        const tinygltf::Model& model = document_.model();
        if (model.scenes.empty()) {
            std::vector<int> result;
            for (std::size_t i = 0; i < model.nodes.size(); ++i)
                if (parent_[i] < 0)
                    result.push_back(int(i));
            return result;
        }
        const std::size_t wanted = model.defaultScene >= 0 && std::size_t(model.defaultScene) < model.scenes.size()
                                       ? std::size_t(model.defaultScene)
                                       : 0;
        std::size_t chosen = wanted;
        if (!has_mesh(wanted))
            for (std::size_t s = 0; s < model.scenes.size(); ++s)
                if (has_mesh(s)) {
                    chosen = s;
                    notes.push_back("the default scene is empty: scene " + std::to_string(s) + " was read");
                    break;
                }
        for (std::size_t s = 0; s < std::min<std::size_t>(model.scenes.size(), 64); ++s)
            if (s != chosen && has_mesh(s))
                notes.push_back("scene " + std::to_string(s) +
                                (model.scenes[s].name.empty() ? "" : " '" + model.scenes[s].name + "'") +
                                " was left out: one scene is read");
        for (const int index : model.scenes[chosen].nodes)
            check_node(index, "scene " + std::to_string(chosen));
        return model.scenes[chosen].nodes;
    }

    /// The meshes of the roots and of what is below them.
    std::vector<Instance> instances(const std::vector<int>& roots) const {
        std::vector<bool> drawn(parent_.size(), false);
        for (const int root : roots)
            drawn[std::size_t(root)] = true;
        std::vector<Instance> result;
        for (const int index : order_) {
            const int up = parent_[std::size_t(index)];
            drawn[std::size_t(index)] = drawn[std::size_t(index)] || (up >= 0 && drawn[std::size_t(up)]);
            const int mesh = document_.model().nodes[std::size_t(index)].mesh;
            if (!drawn[std::size_t(index)] || mesh < 0)
                continue;
            if (std::size_t(mesh) >= document_.model().meshes.size())
                document_.fail("node " + std::to_string(index) + ": mesh " + std::to_string(mesh) + " does not exist");
            result.push_back({mesh, index, world_[std::size_t(index)]});
        }
        return result;
    }

  private:
    /// Parents before children, each node's children in order; and the products of transforms along the way.
    void order_nodes() {
        const auto& nodes = document_.model().nodes;
        world_.resize(nodes.size());
        std::vector<int> stack;
        for (std::size_t root = nodes.size(); root-- > 0;)
            if (parent_[root] < 0)
                stack.push_back(int(root));
        while (!stack.empty()) {
            const int index = stack.back();
            stack.pop_back();
            order_.push_back(index);
            const int up = parent_[std::size_t(index)];
            const glm::dmat4 local = local_transform(document_, index);
            world_[std::size_t(index)] = up < 0 ? local : world_[std::size_t(up)] * local;
            const std::vector<int>& children = nodes[std::size_t(index)].children;
            stack.insert(stack.end(), children.rbegin(), children.rend());
        }
        if (order_.size() != nodes.size())
            document_.fail("its nodes form a cycle: some are their own ancestors");
    }

    void check_node(int index, const std::string& place) const {
        if (index < 0 || std::size_t(index) >= document_.model().nodes.size())
            document_.fail(place + ": node " + std::to_string(index) + " does not exist");
    }

    bool has_mesh(std::size_t scene) const {
        std::vector<int> stack = document_.model().scenes[scene].nodes;
        std::size_t steps = 0;
        while (!stack.empty() && steps++ <= document_.model().nodes.size()) {
            const int index = stack.back();
            stack.pop_back();
            if (index < 0 || std::size_t(index) >= document_.model().nodes.size())
                continue;
            const tinygltf::Node& node = document_.model().nodes[std::size_t(index)];
            if (node.mesh >= 0)
                return true;
            stack.insert(stack.end(), node.children.begin(), node.children.end());
        }
        return false;
    }

    const GltfDocument& document_;
    std::vector<int> parent_;
    std::vector<int> order_;
    std::vector<glm::dmat4> world_;
};

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

int attribute(const tinygltf::Primitive& primitive, const std::string& name) {
    const auto found = primitive.attributes.find(name);
    return found == primitive.attributes.end() ? -1 : found->second;
}

/// A primitive as the file stores it, before any transform.
struct RawMesh {
    std::vector<float> positions, normals, uvs;
    std::vector<glm::vec4> colors;
    std::vector<glm::uvec3> triangles;
    std::map<std::string, int> custom_attributes;
    int material = 0;
};

std::vector<glm::vec4> read_colors(const GltfDocument& document, int accessor) {
    const int type = document.model().accessors[std::size_t(accessor)].type;
    const int components = type == TINYGLTF_TYPE_VEC4 ? 4 : 3;
    const std::vector<float> values = document.floats(accessor, components);
    std::vector<glm::vec4> colors(values.size() / std::size_t(components), glm::vec4(1.f));
    for (std::size_t i = 0; i < colors.size(); ++i)
        for (std::size_t c = 0; c < std::size_t(components); ++c)
            colors[i][c] = values[i * std::size_t(components) + c];
    return colors;
}

RawMesh read_primitive(const GltfDocument& document, const tinygltf::Primitive& primitive,
                       const std::vector<GltfMaterial>& materials, const std::string& place) {
    RawMesh raw;
    const int position = attribute(primitive, "POSITION");
    if (position < 0)
        document.fail(place + " has no POSITION");
    const std::size_t vertices = document.accessor_count(position);
    for (const auto& [name, accessor] : primitive.attributes)
        if (document.accessor_count(accessor) != vertices)
            document.fail(place + ": " + name + " has " + std::to_string(document.accessor_count(accessor)) +
                          " elements for " + std::to_string(vertices) + " vertices");
    if (primitive.material >= 0 && std::size_t(primitive.material) + 1 >= materials.size())
        document.fail(place + ": material " + std::to_string(primitive.material) + " does not exist");
    raw.material = primitive.material >= 0 ? primitive.material : int(materials.size()) - 1;
    raw.positions = document.floats(position, 3);
    for (std::size_t i = 0; i < raw.positions.size(); ++i)
        if (!std::isfinite(raw.positions[i]))
            document.fail(place + ": vertex " + std::to_string(i / 3) + " is not finite");
    if (const int normal = attribute(primitive, "NORMAL"); normal >= 0)
        raw.normals = document.floats(normal, 3);
    const auto& texture = materials[std::size_t(raw.material)].base_color_texture;
    const int set = texture ? texture->texture_coordinates : 0;
    if (const int uv = attribute(primitive, "TEXCOORD_" + std::to_string(set)); uv >= 0)
        raw.uvs = document.floats(uv, 2);
    if (const int color = attribute(primitive, "COLOR_0"); color >= 0)
        raw.colors = read_colors(document, color);
    for (const auto& [name, accessor] : primitive.attributes)
        if (name.starts_with('_'))
            raw.custom_attributes[name] = accessor;
    raw.triangles = read_triangles(document, primitive, vertices, place);
    return raw;
}

std::vector<glm::vec2> transformed_uvs(const std::vector<float>& values, const std::optional<GltfTexture>& texture) {
    std::vector<glm::vec2> uvs(values.size() / 2);
    const bool plain =
        !texture || (texture->offset == glm::vec2(0.f) && texture->scale == glm::vec2(1.f) && texture->rotation == 0);
    const float cosine = texture ? std::cos(texture->rotation) : 1.f,
                sine = texture ? std::sin(texture->rotation) : 0.f;
    for (std::size_t i = 0; i < uvs.size(); ++i) {
        glm::vec2 uv(values[2 * i], values[2 * i + 1]);
        if (!std::isfinite(uv.x) || !std::isfinite(uv.y))
            uv = glm::vec2(0.f);
        if (!plain) { // KHR_texture_transform: translation * rotation * scale
            uv *= texture->scale;
            uv = texture->offset + glm::vec2(cosine * uv.x + sine * uv.y, -sine * uv.x + cosine * uv.y);
        }
        uvs[i] = uv;
    }
    return uvs;
}

glm::dvec3 position_of(const RawMesh& raw, std::size_t i) {
    return {raw.positions[3 * i], raw.positions[3 * i + 1], raw.positions[3 * i + 2]};
}

/// Cofactor matrix = determinant x inverse transpose, which also exists for flat scales.
glm::dmat3 cofactors(const glm::dmat3& m) {
    return glm::dmat3(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
}

GltfMesh place_mesh(const RawMesh& raw, const glm::dmat4& transform, const std::optional<GltfTexture>& texture) {
    GltfMesh mesh;
    const glm::dmat3 linear(transform);
    const bool mirrored = glm::determinant(linear) < 0;
    const bool identity = transform == glm::dmat4(1.0);
    const std::size_t vertices = raw.positions.size() / 3;
    mesh.positions.resize(vertices);
    for (std::size_t i = 0; i < vertices; ++i)
        mesh.positions[i] =
            glm::vec3(identity ? position_of(raw, i) : linear * position_of(raw, i) + glm::dvec3(transform[3]));
    mesh.triangles = raw.triangles;
    if (mirrored)
        for (glm::uvec3& triangle : mesh.triangles)
            std::swap(triangle.y, triangle.z);
    const std::vector<glm::vec3> computed =
        raw.normals.empty() ? compute_normals(mesh.positions, mesh.triangles) : std::vector<glm::vec3>();
    if (raw.normals.empty()) {
        mesh.normals = computed;
    } else {
        const glm::dmat3 normal_matrix = mirrored ? -cofactors(linear) : cofactors(linear);
        std::vector<glm::vec3> fallback;
        mesh.normals.resize(vertices);
        for (std::size_t i = 0; i < vertices; ++i) {
            const glm::vec3 stored(raw.normals[3 * i], raw.normals[3 * i + 1], raw.normals[3 * i + 2]);
            const glm::dvec3 normal = identity ? glm::dvec3(stored) : normal_matrix * glm::dvec3(stored);
            const double length = glm::length(normal);
            if (length > 0 && std::isfinite(length)) {
                // An identity transform keeps the stored bits, so that a file of ours reloads exactly.
                mesh.normals[i] = identity && std::abs(length - 1) < 1e-4 ? stored : glm::vec3(normal / length);
            } else {
                if (fallback.empty())
                    fallback = compute_normals(mesh.positions, mesh.triangles);
                mesh.normals[i] = fallback[i];
            }
        }
    }
    mesh.uvs = transformed_uvs(raw.uvs, texture);
    mesh.colors = raw.colors;
    mesh.custom_attributes = raw.custom_attributes;
    mesh.material = raw.material;
    return mesh;
}

/// 0, unless the scene is so far away that floats would coarsen it.
glm::dvec3 choose_origin(const glm::dvec3& low, const glm::dvec3& high) {
    if (!(low.x <= high.x))
        return glm::dvec3(0.0);
    const glm::dvec3 centre = 0.5 * (low + high);
    return glm::length(centre) > 16 * glm::length(high - low) ? centre : glm::dvec3(0.0);
}

void note_what_is_ignored(const tinygltf::Model& model, std::vector<std::string>& notes) {
    if (!model.skins.empty())
        notes.push_back("skins are not applied: meshes are read in their bind pose");
    for (const std::string& extension : model.extensionsUsed)
        if (extension == "EXT_mesh_gpu_instancing")
            notes.push_back("EXT_mesh_gpu_instancing is not applied: each instanced mesh is read once");
}

} // namespace

std::vector<glm::vec3> compute_normals(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles) {
    std::vector<glm::dvec3> sums(positions.size(), glm::dvec3(0.0));
    for (const glm::uvec3& t : triangles) {
        const glm::dvec3 a(positions[t.x]), b(positions[t.y]), c(positions[t.z]);
        const glm::dvec3 normal = glm::cross(b - a, c - a);
        for (const std::uint32_t corner : {t.x, t.y, t.z})
            sums[corner] += normal;
    }
    std::vector<glm::vec3> normals(positions.size());
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const double length = glm::length(sums[i]);
        normals[i] = length > 0 && std::isfinite(length) ? glm::vec3(sums[i] / length) : glm::vec3(0, 1, 0);
    }
    return normals;
}

GltfScene flatten(const GltfDocument& document, std::optional<glm::dvec3> origin, Progress& progress) {
    GltfScene scene;
    const tinygltf::Model& model = document.model();
    note_what_is_ignored(model, scene.notes);
    const SceneWalk walk(document);
    const std::vector<Instance> instances = walk.instances(walk.roots(scene.notes));
    if (instances.empty())
        document.fail("holds no mesh in its scene");
    scene.materials = read_gltf_materials(document, progress);

    std::map<int, std::vector<std::pair<int, RawMesh>>> meshes; // by mesh of the file: its triangle primitives
    std::size_t vertices = 0, skipped = 0;
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-std::numeric_limits<double>::infinity());
    for (const Instance& instance : instances) {
        progress.throw_if_stopped();
        auto [found, is_new] = meshes.try_emplace(instance.mesh);
        const tinygltf::Mesh& source = model.meshes[std::size_t(instance.mesh)];
        if (is_new)
            for (std::size_t p = 0; p < source.primitives.size(); ++p) {
                const tinygltf::Primitive& primitive = source.primitives[p];
                const std::string place = "mesh " + std::to_string(instance.mesh) +
                                          (source.name.empty() ? "" : " '" + source.name + "'") + ", primitive " +
                                          std::to_string(p);
                if (primitive.mode < TINYGLTF_MODE_TRIANGLES && primitive.mode >= 0) {
                    ++skipped;
                    continue;
                }
                found->second.emplace_back(int(p), read_primitive(document, primitive, scene.materials, place));
            }
        for (const auto& [p, raw] : found->second) {
            vertices += raw.positions.size() / 3;
            if (vertices > kMaximumVertices)
                document.fail("its scene has more than the limit of " + std::to_string(kMaximumVertices) + " vertices");
            for (std::size_t i = 0; i < raw.positions.size() / 3; ++i) {
                const glm::dvec3 position = glm::dvec3(instance.transform * glm::dvec4(position_of(raw, i), 1.0));
                low = glm::min(low, position);
                high = glm::max(high, position);
            }
        }
    }
    if (skipped > 0)
        scene.notes.push_back(std::to_string(skipped) + " primitives of points or lines were left out");
    scene.origin = origin.value_or(choose_origin(low, high));
    if (glm::any(glm::greaterThan(glm::max(glm::abs(low - scene.origin), glm::abs(high - scene.origin)),
                                  glm::dvec3(1e30))) &&
        low.x <= high.x)
        document.fail("its scene reaches farther than 1e30 m");
    for (const Instance& instance : instances) {
        progress.throw_if_stopped();
        glm::dmat4 transform = instance.transform;
        transform[3] -=
            glm::dvec4(scene.origin, 0.0); // before it is applied, so that a file of ours gets its bits back
        for (const auto& [p, raw] : meshes.at(instance.mesh)) {
            GltfMesh mesh = place_mesh(raw, transform, scene.materials[std::size_t(raw.material)].base_color_texture);
            mesh.mesh_name = model.meshes[std::size_t(instance.mesh)].name;
            mesh.name = model.nodes[std::size_t(instance.node)].name;
            if (mesh.name.empty())
                mesh.name = mesh.mesh_name;
            mesh.mesh_index = instance.mesh;
            mesh.primitive_index = p;
            scene.meshes.push_back(std::move(mesh));
        }
    }
    return scene;
}

} // namespace kokage
