#include "viewer/scene/object_tree.h"
#include "common/geometry/split_long_edges.h"
#include "common/gltf/gltf_scene.h"
#include "common/obj/obj_scene.h"
#include "common/services/error.h"
#include "common/services/named_file.h"
#include "common/stl/stl_scene.h"
#include "trees/foreign_tree.h"
#include "trees/surface_patches.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace kokage {
namespace {

constexpr glm::vec3 kGrey(0.5f);              ///< of what says nothing of its colour
constexpr double kPatchRadius = 0.025;        ///< of the object's diagonal: some hundreds of patches on a ball
constexpr std::size_t kMostPieces = 1u << 20; ///< no more triangles come of splitting

std::shared_ptr<const Image> channel_of(const Image& image, std::size_t channel) {
    auto single = std::make_shared<Image>(image.width, image.height, 1);
    for (std::size_t i = 0; i < single->pixels.size(); ++i)
        single->pixels[i] = image.pixels[i * std::size_t(image.channels) + channel];
    return single;
}

float mean_of(const Image& image) {
    double sum = 0;
    for (const float value : image.pixels)
        sum += double(value);
    return image.pixels.empty() ? 1.f : float(sum / double(image.pixels.size()));
}

Finish finish_of(const SceneMaterial& source, TreeMaterial& material, std::vector<std::string>& notes) {
    Finish finish;
    finish.metallic = source.metallic;
    finish.index_of_refraction = source.index_of_refraction;
    if (!source.roughness_metallic_texture)
        return finish;
    const SceneTexture& texture = *source.roughness_metallic_texture;
    const std::shared_ptr<const Image> roughness = channel_of(*texture.color, 1);
    finish.metallic *= mean_of(*channel_of(*texture.color, 2));
    const SceneTexture untransformed;
    if (lies_alike(texture, source.base_color_texture ? *source.base_color_texture : untransformed)) {
        finish.roughness_texture = roughness;
    } else {
        material.roughness *= mean_of(*roughness);
        notes.push_back("material '" + shown_name(source.name) +
                        "': its roughness texture lies otherwise than its colours: its mean is taken");
    }
    return finish;
}

/// A mesh cut fine enough that patches of that radius can be made of it.
SceneMesh cut_fine(const SceneMesh& mesh, double radius) {
    SceneMesh fine = mesh;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> middles;
    std::vector<std::uint32_t> source;
    split_long_edges(2 * radius, kMostPieces, fine.positions, fine.triangles, middles, source);
    for (const auto& [a, b] : middles) {
        const glm::vec3 normal = fine.normals[a] + fine.normals[b];
        const float length = glm::length(normal);
        fine.normals.push_back(length > 0 ? normal / length : fine.normals[a]);
        if (!fine.uvs.empty())
            fine.uvs.push_back(0.5f * (fine.uvs[a] + fine.uvs[b]));
    }
    return fine;
}

TreePart part_of(const SceneMesh& mesh, std::uint32_t material, double radius, std::uint32_t& patches) {
    const SceneMesh fine = cut_fine(mesh, radius);
    SurfacePatchLimits limits;
    limits.max_radius = [radius](const glm::vec3&) { return float(radius); };
    limits.keep_cards = false;
    const std::vector<std::uint32_t> patch = surface_patches(fine.positions, fine.triangles, limits);
    std::vector<std::uint32_t> order(patch.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return patch[a] < patch[b]; });
    TreePart part;
    part.kind = TreePartKind::bark;
    part.material = material;
    part.positions = fine.positions;
    part.normals = fine.normals;
    part.uvs = fine.uvs;
    std::uint32_t count = 0;
    for (const std::uint32_t t : order) {
        part.triangles.push_back(fine.triangles[t]);
        part.triangle_patch.push_back(patches + patch[t]);
        count = std::max(count, patch[t] + 1);
    }
    patches += count;
    return part;
}

/// Vertex colours as their mean.
glm::vec3 mean_color(const SceneMesh& mesh) {
    glm::dvec3 sum(0.0);
    for (const glm::vec4& color : mesh.colors)
        sum += glm::dvec3(color);
    return mesh.colors.empty() ? glm::vec3(1.f) : glm::vec3(sum / double(mesh.colors.size()));
}

} // namespace

MeshScene read_object(const std::filesystem::path& file, Progress& progress) {
    const std::string ending = lower_ending(file);
    if (ending == ".obj")
        return read_obj_scene(file, progress);
    if (ending == ".stl")
        return read_stl_scene(file);
    if (ending != ".glb" && ending != ".gltf")
        throw InputError(file.string() + ": an object is a .glb, .gltf, .obj or .stl");
    const GltfDocument document = GltfDocument::read(file, progress);
    MeshScene scene = flatten(document, std::nullopt, progress);
    read_gltf_gloss_textures(document, scene, progress);
    read_gltf_normal_textures(document, scene, progress);
    return scene;
}

ObjectTree object_tree(MeshScene scene, const std::filesystem::path& file, bool z_is_up) {
    if (z_is_up)
        set_upright(scene);
    ObjectTree object;
    object.tree.name = file.stem().string();
    object.tree.source = file.string();
    object.tree.origin = scene.origin;
    object.tree.notes = scene.notes;
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    glm::dvec3 low(kInfinity), high(-kInfinity);
    for (const SceneMesh& mesh : scene.meshes)
        for (const glm::uvec3& triangle : mesh.triangles)
            for (std::size_t k = 0; k < 3; ++k) {
                low = glm::min(low, glm::dvec3(mesh.positions[triangle[k]]));
                high = glm::max(high, glm::dvec3(mesh.positions[triangle[k]]));
            }
    if (!(low.x <= high.x))
        throw InputError(file.string() + ": it has no triangles, so there is nothing to see of it");
    if (!(glm::length(high - low) > 0))
        throw InputError(file.string() + ": it has no size: all corners of its triangles are one point");
    object.low = low;
    object.high = high;
    const double radius = kPatchRadius * glm::length(high - low);
    for (const SceneMesh& mesh : scene.meshes) {
        if (mesh.triangles.empty())
            continue;
        const SceneMaterial& source = scene.materials[std::size_t(mesh.material)];
        TreeMaterial material = tree_material(source, mean_color(mesh), object.tree.notes);
        const bool says_nothing = source.color_is_lost || (source.is_missing && mesh.colors.empty());
        if (says_nothing) {
            material.base_color = kGrey;
            object.tree.notes.push_back("'" + shown_name(mesh.name) + "' has no colour: it is grey");
        }
        object.finishes.push_back(finish_of(source, material, object.tree.notes));
        if (source.is_missing)
            object.finishes.back().metallic = 0;
        const auto number = std::uint32_t(object.tree.materials.size());
        object.tree.materials.push_back(std::move(material));
        object.tree.parts.push_back(part_of(mesh, number, radius, object.tree.bark_patch_count));
    }
    return object;
}

} // namespace kokage
