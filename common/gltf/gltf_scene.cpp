#include "common/gltf/gltf_scene.h"

#include "common/gltf/check_gltf.h"
#include "common/gltf/gltf_materials.h"
#include "common/gltf/gltf_nodes.h"
#include "common/gltf/gltf_primitives.h"
#include "common/services/count_text.h"
#include "common/services/named_file.h"

#include <cmath>
#include <limits>
#include <tiny_gltf.h>

namespace kokage {
namespace {

/// KHR_texture_transform: translation * rotation * scale.
std::vector<glm::vec2> transformed_uvs(std::vector<glm::vec2> uvs, const std::optional<SceneTexture>& texture) {
    if (!texture || (texture->offset == glm::vec2(0.f) && texture->scale == glm::vec2(1.f) && texture->rotation == 0))
        return uvs;
    const float cosine = std::cos(texture->rotation), sine = std::sin(texture->rotation);
    for (glm::vec2& uv : uvs) {
        uv *= texture->scale;
        uv = texture->offset + glm::vec2(cosine * uv.x + sine * uv.y, -sine * uv.x + cosine * uv.y);
        if (!std::isfinite(uv.x) || !std::isfinite(uv.y))
            uv = glm::vec2(0.f);
    }
    return uvs;
}

glm::dvec3 moved(const glm::dmat4& transform, const glm::dvec3& position) {
    return glm::dmat3(transform) * position + glm::dvec3(transform[3]);
}

/// The primitive under one transform.
SceneMesh place_mesh(const GltfPrimitive& raw, const glm::dmat4& transform,
                     const std::optional<SceneTexture>& texture) {
    SceneMesh mesh;
    const glm::dmat3 linear(transform);
    const bool mirrored = glm::determinant(linear) < 0;
    const bool identity = transform == glm::dmat4(1.0);
    const std::size_t vertices = raw.positions.size();
    mesh.positions.resize(vertices);
    for (std::size_t i = 0; i < vertices; ++i)
        mesh.positions[i] = glm::vec3(identity ? raw.positions[i] : moved(transform, raw.positions[i]));
    mesh.triangles = raw.triangles;
    if (mirrored)
        for (glm::uvec3& triangle : mesh.triangles)
            std::swap(triangle.y, triangle.z);
    if (raw.normals.empty()) {
        mesh.normals = compute_normals(mesh.positions, mesh.triangles);
    } else {
        const glm::dmat3 normal_matrix = mirrored ? -cofactors(linear) : cofactors(linear);
        std::vector<glm::vec3> fallback;
        mesh.normals.resize(vertices);
        for (std::size_t i = 0; i < vertices; ++i) {
            const glm::vec3& stored = raw.normals[i];
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
    mesh.material = raw.material;
    return mesh;
}

void append(SceneMesh& mesh, const SceneMesh& more) {
    const auto first = std::uint32_t(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), more.positions.begin(), more.positions.end());
    mesh.normals.insert(mesh.normals.end(), more.normals.begin(), more.normals.end());
    mesh.uvs.insert(mesh.uvs.end(), more.uvs.begin(), more.uvs.end());
    mesh.colors.insert(mesh.colors.end(), more.colors.begin(), more.colors.end());
    for (const glm::uvec3& triangle : more.triangles)
        mesh.triangles.push_back(triangle + first);
}

class Flattening {
  public:
    Flattening(const GltfDocument& document, MeshScene& scene, Progress& progress)
        : document_(document), scene_(scene), progress_(progress), nodes_(document),
          placements_(nodes_.placements(scene.notes)) {
        if (placements_.empty())
            document.fail("holds no mesh in its scene");
        scene.materials = read_gltf_materials(document, scene.notes, progress);
    }

    void read() {
        std::size_t lines = 0;
        for (const GltfPlacement& placement : placements_) {
            progress_.throw_if_stopped();
            const tinygltf::Mesh& mesh = document_.model().meshes[std::size_t(placement.mesh)];
            for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
                if (mesh.primitives[p].mode < TINYGLTF_MODE_TRIANGLES && mesh.primitives[p].mode >= 0)
                    ++lines;
                else
                    read_placed(placement, int(p));
            }
        }
        if (lines > 0)
            scene_.notes.push_back(
                counted(lines, "primitive of points or lines was", "primitives of points or lines were") + " left out");
    }

    void place(std::optional<glm::dvec3> origin) {
        scene_.origin = origin.value_or(choose_origin(low_, high_));
        if (low_.x <= high_.x &&
            glm::any(glm::greaterThan(glm::max(glm::abs(low_ - scene_.origin), glm::abs(high_ - scene_.origin)),
                                      glm::dvec3(1e30))))
            document_.fail("its scene reaches farther than 1e30 m");
        for (const Placed& placed : placed_) {
            progress_.throw_if_stopped();
            place_one(placed);
        }
    }

  private:
    struct Placed {
        const GltfPlacement* placement;
        int primitive;
        const GltfPrimitive* raw;
        std::vector<glm::dmat4> transforms;
    };

    void read_placed(const GltfPlacement& placement, int p) {
        const tinygltf::Mesh& mesh = document_.model().meshes[std::size_t(placement.mesh)];
        const tinygltf::Primitive& source = mesh.primitives[std::size_t(p)];
        const std::string place = "mesh " + std::to_string(placement.mesh) +
                                  (mesh.name.empty() ? "" : " '" + shown_name(mesh.name) + "'") + ", primitive " +
                                  std::to_string(p);
        auto [found, is_new] = primitives_.try_emplace({placement.mesh, p});
        if (is_new)
            found->second = read_gltf_primitive(document_, source, scene_.materials, place);
        Placed placed{&placement, p, &found->second, placement.transforms};
        if (is_deformed(document_, placement.node, source)) {
            deformed_.push_back(std::make_unique<GltfPrimitive>(
                deformed(document_, nodes_, placement.node, source, found->second, place)));
            placed.raw = deformed_.back().get();
            if (document_.model().nodes[std::size_t(placement.node)].skin >= 0)
                placed.transforms = {glm::dmat4(1.0)};
        }
        count(placed);
        placed_.push_back(std::move(placed));
    }

    /// Sizes, before memory is taken for what instances repeat.
    void count(const Placed& placed) {
        const std::size_t instances = placed.transforms.size();
        vertices_ += placed.raw->positions.size() * instances;
        triangles_ += placed.raw->triangles.size() * instances;
        if (vertices_ > kMaximumSceneVertices || triangles_ > kMaximumSceneTriangles)
            document_.fail("its scene has more than the limit of " + std::to_string(kMaximumSceneVertices) +
                           " vertices, or as many triangles");
        if (placed_.size() >= kMaximumMeshes)
            document_.fail("its scene has more than the limit of " + std::to_string(kMaximumMeshes) + " meshes");
        for (const glm::dmat4& transform : placed.transforms)
            for (const glm::dvec3& raw : placed.raw->positions) {
                const glm::dvec3 position = moved(transform, raw);
                low_ = glm::min(low_, position);
                high_ = glm::max(high_, position);
            }
    }

    void place_one(const Placed& placed) {
        const tinygltf::Model& model = document_.model();
        SceneMesh whole;
        for (std::size_t i = 0; i < placed.transforms.size(); ++i) {
            glm::dmat4 transform = placed.transforms[i];
            // Before it is applied, so that a file of ours gets its bits back.
            transform[3] -= glm::dvec4(scene_.origin, 0.0);
            SceneMesh mesh = place_mesh(*placed.raw, transform,
                                        scene_.materials[std::size_t(placed.raw->material)].base_color_texture);
            if (i == 0)
                whole = std::move(mesh);
            else
                append(whole, mesh);
        }
        if (placed.transforms.size() == 1)
            whole.custom_attributes = placed.raw->custom_attributes;
        whole.material = placed.raw->material;
        whole.mesh_name = model.meshes[std::size_t(placed.placement->mesh)].name;
        whole.name = model.nodes[std::size_t(placed.placement->node)].name;
        if (whole.name.empty())
            whole.name = whole.mesh_name;
        whole.mesh_index = placed.placement->mesh;
        whole.primitive_index = placed.primitive;
        scene_.meshes.push_back(std::move(whole));
    }

    const GltfDocument& document_;
    MeshScene& scene_;
    Progress& progress_;
    GltfNodes nodes_;
    std::vector<GltfPlacement> placements_;
    std::map<std::pair<int, int>, GltfPrimitive> primitives_; ///< by mesh and primitive of the file
    std::vector<std::unique_ptr<GltfPrimitive>> deformed_;
    std::vector<Placed> placed_;
    std::size_t vertices_ = 0, triangles_ = 0;
    glm::dvec3 low_{std::numeric_limits<double>::infinity()}, high_{-std::numeric_limits<double>::infinity()};
};

} // namespace

MeshScene flatten(const GltfDocument& document, std::optional<glm::dvec3> origin, Progress& progress) {
    MeshScene scene;
    Flattening flattening(document, scene, progress);
    flattening.read();
    flattening.place(origin);
    return scene;
}

} // namespace kokage
