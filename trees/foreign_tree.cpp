#include "trees/foreign_tree.h"

#include "common/geometry/triangle_topology.h"
#include "common/services/count_text.h"
#include "common/services/error.h"
#include "common/services/named_file.h"
#include "trees/axis_samples.h"
#include "trees/find_branching.h"
#include "trees/find_foliage.h"
#include "trees/find_leaves.h"
#include "trees/part_names.h"
#include "trees/stand_in_colors.h"
#include "trees/surface_patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

namespace kokage {
namespace {

double area_of(const std::vector<glm::vec3>& positions, const glm::uvec3& t) {
    const glm::dvec3 a(positions[t.x]), b(positions[t.y]), c(positions[t.z]);
    return 0.5 * glm::length(glm::cross(b - a, c - a));
}

/// Drops triangles whose corners coincide, and of two triangles with the same corners in opposite directions (a sheet
/// drawn twice for viewers that cull back faces) the second: leaves are two-sided here.
void drop_degenerate_and_back_faces(SceneMesh& mesh, bool drop_back_faces, std::size_t& back_faces) {
    const std::vector<std::uint32_t> welded = weld(mesh.positions);
    std::set<std::array<std::uint32_t, 3>> seen;
    std::vector<glm::uvec3> kept;
    kept.reserve(mesh.triangles.size());
    for (const glm::uvec3& t : mesh.triangles) {
        std::array<std::uint32_t, 3> corners{welded[t.x], welded[t.y], welded[t.z]};
        if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0])
            continue;
        if (drop_back_faces) {
            // Rotated so that the lowest comes first: the order of the other two tells the direction.
            std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
            const std::array<std::uint32_t, 3> reversed{corners[0], corners[2], corners[1]};
            if (seen.contains(reversed)) {
                ++back_faces;
                continue;
            }
            seen.insert(corners);
        }
        kept.push_back(t);
    }
    mesh.triangles = std::move(kept);
}

glm::vec3 mean_vertex_color(const SceneMesh& mesh) {
    glm::dvec3 sum(0.0);
    double weight = 0;
    for (const glm::uvec3& t : mesh.triangles) {
        const double area = area_of(mesh.positions, t);
        for (const std::uint32_t v : {t.x, t.y, t.z})
            sum += area * glm::dvec3(glm::clamp(glm::vec3(mesh.colors[v]), 0.f, 1.f));
        weight += 3 * area;
    }
    return weight > 0 && std::isfinite(sum.x + sum.y + sum.z) ? glm::vec3(sum / weight) : glm::vec3(1.f);
}

/// A part in the making: meshes of the same kind and look, one after the other, only the vertices that they use.
class PartBuilder {
  public:
    TreePart part;

    void append(const SceneMesh& mesh, const std::vector<std::uint32_t>& patch, std::uint32_t first_patch) {
        std::vector<std::uint32_t> order(mesh.triangles.size());
        std::iota(order.begin(), order.end(), 0u);
        std::stable_sort(order.begin(), order.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return patch[a] < patch[b]; });
        std::vector<std::uint32_t> index(mesh.positions.size(), ~0u);
        const bool has_uvs = !mesh.uvs.empty();
        if (has_uvs && part.uvs.empty())
            part.uvs.assign(part.positions.size(), glm::vec2(0.f));
        for (const std::uint32_t t : order) {
            glm::uvec3 triangle;
            for (std::size_t c = 0; c < 3; ++c) {
                std::uint32_t& v = index[mesh.triangles[t][c]];
                if (v == ~0u) {
                    v = std::uint32_t(part.positions.size());
                    part.positions.push_back(mesh.positions[mesh.triangles[t][c]]);
                    part.normals.push_back(mesh.normals[mesh.triangles[t][c]]);
                    if (!part.uvs.empty() || has_uvs)
                        part.uvs.push_back(has_uvs ? mesh.uvs[mesh.triangles[t][c]] : glm::vec2(0.f));
                }
                triangle[c] = v;
            }
            part.triangles.push_back(triangle);
            part.triangle_patch.push_back(first_patch + patch[t]);
        }
    }
};

std::uint32_t patch_count(const std::vector<std::uint32_t>& patch) {
    return patch.empty() ? 0 : *std::max_element(patch.begin(), patch.end()) + 1;
}

std::vector<Leaf> leaf_centres(const Tree& tree, std::uint32_t count) {
    std::vector<glm::dvec3> sums(count, glm::dvec3(0.0)), plain(count, glm::dvec3(0.0));
    std::vector<double> areas(count, 0.0), triangles(count, 0.0);
    for (const TreePart& part : tree.parts) {
        if (part.kind != TreePartKind::foliage)
            continue;
        for (std::size_t t = 0; t < part.triangles.size(); ++t) {
            const glm::uvec3& triangle = part.triangles[t];
            const glm::dvec3 centre = (glm::dvec3(part.positions[triangle.x]) + glm::dvec3(part.positions[triangle.y]) +
                                       glm::dvec3(part.positions[triangle.z])) /
                                      3.0;
            const double area = area_of(part.positions, triangle);
            const std::uint32_t leaf = part.triangle_patch[t];
            sums[leaf] += area * centre;
            areas[leaf] += area;
            plain[leaf] += centre;
            triangles[leaf] += 1;
        }
    }
    std::vector<Leaf> leaves(count);
    for (std::uint32_t i = 0; i < count; ++i)
        leaves[i].centre = glm::vec3(areas[i] > 0 ? sums[i] / areas[i] : plain[i] / std::max(triangles[i], 1.0));
    return leaves;
}

/// Radius of the disc of an average leaf's area.
float mean_leaf_radius(const Tree& tree) {
    double area = 0;
    for (const TreePart& part : tree.parts)
        if (part.kind == TreePartKind::foliage)
            for (const glm::uvec3& triangle : part.triangles)
                area += area_of(part.positions, triangle);
    return tree.leaves.empty() ? 0.f : float(std::sqrt(area / double(tree.leaves.size()) / kPiDouble));
}

/// Bark patches: about as long as the wood is thick around, but no smaller than a quarter of a leaf across, and turning
/// by at most 45 degrees, except on twigs, which a ring fits.
void cut_bark(Tree& tree, std::vector<SceneMesh>& bark, const std::map<std::pair<int, int>, std::size_t>& part_of,
              std::vector<PartBuilder>& parts, float crown) {
    const NearestAxis nearest_axis(tree.skeleton);
    const float least = std::max(0.005f * crown, 0.25f * mean_leaf_radius(tree));
    SurfacePatchLimits limits;
    limits.max_turn = 0.7854f;
    limits.keep_cards = false;
    limits.max_radius = [&](const glm::vec3& place) {
        const AxisPlace nearest = nearest_axis.at(place);
        // A quarter of the circumference wide and as long as the circumference: an area of (2 pi r)^2 / 4.
        const float around = 2 * kPi * (nearest.found ? std::max(nearest.radius_m, 0.2f * nearest.distance) : crown);
        return std::max(0.5f * around / std::sqrt(kPi), least);
    };
    for (SceneMesh& mesh : bark) {
        const std::vector<std::uint32_t> patch = surface_patches(mesh.positions, mesh.triangles, limits);
        const std::size_t index = part_of.at({mesh.material, 1});
        parts[index].append(mesh, patch, tree.bark_patch_count);
        tree.bark_patch_count += patch_count(patch);
    }
}

} // namespace

TreeMaterial tree_material(const SceneMaterial& source, const glm::vec3& color_factor,
                           std::vector<std::string>& notes) {
    TreeMaterial material;
    material.name = source.name;
    material.base_color = glm::vec3(source.base_color) * color_factor;
    material.double_sided = source.double_sided;
    material.roughness = source.roughness;
    if (source.diffuse_transmission) {
        material.diffuse_transmission = *source.diffuse_transmission;
        material.diffuse_transmission_color = source.diffuse_transmission_color;
    }
    const bool cut = source.alpha_mode != AlphaMode::opaque;
    material.alpha_cutoff = source.alpha_mode == AlphaMode::mask ? source.alpha_cutoff : 0.5f;
    if (source.base_color_texture) {
        material.base_color_texture = source.base_color_texture->color;
        material.wrap_u = source.base_color_texture->wrap_u;
        material.wrap_v = source.base_color_texture->wrap_v;
        if (cut)
            material.alpha_texture = source.base_color_texture->alpha;
    }
    if (material.alpha_texture && source.base_color.a < 1 && source.base_color.a > 0)
        material.alpha_cutoff /= source.base_color.a;
    const std::string name = "material '" + shown_name(source.name) + "'";
    if (source.alpha_mode == AlphaMode::mask && !material.alpha_texture)
        notes.push_back(name + " has an alpha mask, but no texture with alpha: it is solid");
    if (source.alpha_mode == AlphaMode::blend)
        notes.push_back(name + (material.alpha_texture ? " is blended: its alpha is taken as a mask at 0.5"
                                                       : " is blended, but has no texture with alpha: it is solid"));
    return material;
}

Tree read_foreign_tree(const GltfDocument& document, const ReadOptions& options, Progress& progress) {
    return tree_from_scene(flatten(document, std::nullopt, progress), document.path(), options, progress);
}

namespace {

/// Where +Z is up, to where +Y is.
void set_upright(MeshScene& scene) {
    const auto turned = [](const auto& v) { return std::decay_t<decltype(v)>(v.x, v.z, -v.y); };
    scene.origin = turned(scene.origin);
    for (SceneMesh& mesh : scene.meshes) {
        for (glm::vec3& position : mesh.positions)
            position = turned(position);
        for (glm::vec3& normal : mesh.normals)
            normal = turned(normal);
    }
}

} // namespace

Tree tree_from_scene(MeshScene scene, const std::string& path, const ReadOptions& options, Progress& progress) {
    if (options.z_is_up)
        set_upright(scene);
    Tree tree;
    tree.name = std::filesystem::path(path).stem().string();
    tree.source = path;
    tree.origin = scene.origin * options.scale;
    tree.notes = scene.notes;
    if (options.scale != 1)
        for (SceneMesh& mesh : scene.meshes)
            for (glm::vec3& position : mesh.positions)
                position = glm::vec3(glm::dvec3(position) * options.scale);

    progress.begin("finding foliage", 1);
    const FoundFoliage found = find_foliage(scene, options.foliage_materials, path);
    tree.notes.insert(tree.notes.end(), found.notes.begin(), found.notes.end());
    for (std::string& note : stand_in_for_lost_colors(scene, found.kinds))
        tree.notes.push_back(std::move(note));

    // A part for each material and kind; vertex colours make a material of their own, as a mean.
    std::map<std::pair<int, int>, std::size_t> part_of; // (material, kind)
    std::vector<PartBuilder> parts;
    std::vector<SceneMesh> foliage, bark;
    std::size_t back_faces = 0;
    const std::size_t file_materials = scene.materials.size();
    std::vector<glm::vec3> color_factors(file_materials, glm::vec3(1.f));
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
        SceneMesh& mesh = scene.meshes[m];
        const bool is_leaf = found.kinds[m] == TreePartKind::foliage;
        drop_degenerate_and_back_faces(mesh, is_leaf, back_faces);
        if (mesh.triangles.empty())
            continue;
        if (!mesh.colors.empty()) {
            scene.materials.push_back(scene.materials[std::size_t(mesh.material)]);
            color_factors.push_back(mean_vertex_color(mesh));
            mesh.material = int(scene.materials.size()) - 1;
        }
        (is_leaf ? foliage : bark).push_back(std::move(mesh));
    }
    if (scene.materials.size() > file_materials)
        tree.notes.push_back("vertex colours were averaged over each of " +
                             counted(scene.materials.size() - file_materials, "mesh", "meshes"));
    if (back_faces > 0)
        tree.notes.push_back("dropped " + counted(back_faces, "triangle", "triangles") +
                             " that only show others from behind: leaves are two-sided");
    std::map<int, std::uint32_t> material_of;
    const auto part_index = [&](int material, TreePartKind kind) {
        const auto [place, is_new] = part_of.try_emplace({material, kind == TreePartKind::bark ? 1 : 0}, parts.size());
        if (is_new) {
            const auto [number, unseen] = material_of.try_emplace(material, std::uint32_t(tree.materials.size()));
            if (unseen)
                tree.materials.push_back(tree_material(scene.materials[std::size_t(material)],
                                                       color_factors[std::size_t(material)], tree.notes));
            parts.emplace_back().part.kind = kind;
            parts.back().part.material = number->second;
        }
        return place->second;
    };

    // Leaves.
    for (const std::vector<SceneMesh>* meshes : {&foliage, &bark}) // for the crown's radius
        for (const SceneMesh& mesh : *meshes) {
            tree.parts.emplace_back();
            tree.parts.back().kind = meshes == &foliage ? TreePartKind::foliage : TreePartKind::bark;
            tree.parts.back().positions = mesh.positions;
            tree.parts.back().triangles = mesh.triangles;
        }
    const float crown = crown_radius(tree);
    tree.parts.clear();
    const FoundLeaves leaves = find_leaves(foliage, scene.materials, options.leaf_size, crown, progress);
    for (std::size_t m = 0; m < foliage.size(); ++m)
        parts[part_index(foliage[m].material, TreePartKind::foliage)].append(foliage[m], leaves.leaf_of[m], 0);
    const std::uint32_t leaf_count = leaves.count;
    if (options.leaf_size > 0 && options.leaf_size < 1e-3f * crown)
        tree.notes.push_back("the leaf size, " + length_text(options.leaf_size) +
                             ", is less than a thousandth of the " + "crown's radius of " + length_text(crown) +
                             ": foliage falls apart into its triangles if that is not what leaves measure");
    if (leaf_count == 0)
        tree.notes.push_back("no foliage was found: say which material or mesh it is");
    else
        tree.notes.push_back(counted(leaf_count, "leaf", "leaves") +
                             ": connected foliage, cut where it turns by more than 30 degrees or is larger than " +
                             length_text(leaves.largest_radius_m) + " in radius");
    if (leaves.stalks > 0)
        tree.notes.push_back(counted(leaves.stalks, "stalk was", "stalks were") + " joined to their leaves");

    // Bark and branching.
    for (PartBuilder& builder : parts)
        tree.parts.push_back(builder.part);
    tree.leaves = leaf_centres(tree, leaf_count);
    std::set<std::string> objects;
    for (const SceneMesh& mesh : bark) {
        part_index(mesh.material, TreePartKind::bark);
        const std::string& material = scene.materials[std::size_t(mesh.material)].name;
        if (names_object(material)) { // it takes part in the light, but no branch begins in it
            objects.insert(material);
            continue;
        }
        TreePart whole;
        whole.positions = mesh.positions;
        whole.triangles = mesh.triangles;
        tree.parts.push_back(std::move(whole));
    }
    for (const std::string& material : objects)
        tree.notes.push_back("material '" + shown_name(material) + "' is no wood: its name");
    progress.begin("finding branches", 1);
    infer_branching(tree);
    progress.throw_if_stopped();
    cut_bark(tree, bark, part_of, parts, crown);
    tree.parts.clear();
    for (PartBuilder& builder : parts)
        tree.parts.push_back(std::move(builder.part));
    return tree;
}

} // namespace kokage
