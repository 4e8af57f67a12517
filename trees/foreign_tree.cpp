#include "trees/foreign_tree.h"

#include "common/services/count_text.h"
#include "common/services/named_file.h"
#include "trees/axis_samples.h"
#include "trees/clean_mesh.h"
#include "trees/find_branching.h"
#include "trees/find_foliage.h"
#include "trees/find_leaves.h"
#include "trees/part_names.h"
#include "trees/stand_in_colors.h"
#include "trees/surface_patches.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

namespace kokage {
namespace {

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
            const double area = triangle_area(part.positions, triangle);
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
                area += triangle_area(part.positions, triangle);
    return tree.leaves.empty() ? 0.f : float(std::sqrt(area / double(tree.leaves.size()) / kPiDouble));
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
    if (source.normal_texture) {
        if (lies_alike(*source.normal_texture, source.base_color_texture.value_or(SceneTexture()))) {
            material.normal_texture = source.normal_texture->color;
            material.normal_scale = source.normal_scale;
            material.wrap_u = source.normal_texture->wrap_u;
            material.wrap_v = source.normal_texture->wrap_v;
        } else {
            notes.push_back(name + ": its texture of normals lies otherwise than its colours: it is left out");
        }
    }
    if (source.alpha_mode == AlphaMode::mask && !material.alpha_texture)
        notes.push_back(name + " has an alpha mask, but no texture with alpha: it is solid");
    if (source.alpha_mode == AlphaMode::blend)
        notes.push_back(name + (material.alpha_texture ? " is blended: its alpha is taken as a mask at 0.5"
                                                       : " is blended, but has no texture with alpha: it is solid"));
    return material;
}

Tree read_foreign_tree(const GltfDocument& document, const ReadOptions& options, Progress& progress) {
    MeshScene scene = flatten(document, std::nullopt, progress);
    if (options.normal_textures)
        read_gltf_normal_textures(document, scene, progress);
    return tree_from_scene(std::move(scene), document.path(), options, progress);
}

namespace {

/// A tree from a flat scene, step by step.
class ForeignTreeBuilder {
  public:
    ForeignTreeBuilder(MeshScene scene, const std::string& path, const ReadOptions& options, Progress& progress)
        : scene_(std::move(scene)), options_(options), progress_(progress) {
        tree_.name = std::filesystem::path(path).stem().string();
        tree_.source = path;
    }

    Tree build() {
        place();
        progress_.begin("finding foliage", 1);
        const FoundFoliage found = find_foliage(scene_, options_.foliage_materials, tree_.source);
        take_notes(scene_.notes);
        take_notes(found.notes);
        take_notes(stand_in_for_lost_colors(scene_, found.kinds));
        take_meshes(found.kinds);
        make_leaves();
        progress_.begin("finding branches", 1);
        find_wood();
        progress_.throw_if_stopped();
        cut_bark();
        tree_.parts.clear();
        for (PartBuilder& builder : parts_)
            tree_.parts.push_back(std::move(builder.part));
        return std::move(tree_);
    }

  private:
    void take_notes(const std::vector<std::string>& notes) {
        tree_.notes.insert(tree_.notes.end(), notes.begin(), notes.end());
    }

    /// Upright, in metres.
    void place() {
        if (options_.z_is_up)
            set_upright(scene_);
        tree_.origin = scene_.origin * options_.scale;
        if (options_.scale == 1)
            return;
        for (SceneMesh& mesh : scene_.meshes)
            for (glm::vec3& position : mesh.positions)
                position = glm::vec3(glm::dvec3(position) * options_.scale);
    }

    /// Foliage and bark apart; vertex colours make a material of their own, as a mean.
    void take_meshes(const std::vector<TreePartKind>& kinds) {
        std::size_t back_faces = 0;
        const std::size_t file_materials = scene_.materials.size();
        color_factors_.assign(file_materials, glm::vec3(1.f));
        for (std::size_t m = 0; m < scene_.meshes.size(); ++m) {
            SceneMesh& mesh = scene_.meshes[m];
            const bool is_leaf = kinds[m] == TreePartKind::foliage;
            back_faces += drop_degenerate_and_back_faces(mesh, is_leaf);
            if (mesh.triangles.empty())
                continue;
            if (!mesh.colors.empty()) {
                scene_.materials.push_back(scene_.materials[std::size_t(mesh.material)]);
                color_factors_.push_back(mean_vertex_color(mesh));
                mesh.material = int(scene_.materials.size()) - 1;
            }
            (is_leaf ? foliage_ : bark_).push_back(std::move(mesh));
        }
        if (scene_.materials.size() > file_materials)
            tree_.notes.push_back("vertex colours were averaged over each of " +
                                  counted(scene_.materials.size() - file_materials, "mesh", "meshes"));
        if (back_faces > 0)
            tree_.notes.push_back("dropped " + counted(back_faces, "triangle", "triangles") +
                                  " that only show others from behind: leaves are two-sided");
    }

    /// The part for meshes of a material and kind.
    PartBuilder& part_of(int material, TreePartKind kind) {
        const auto [place, is_new] = part_of_.try_emplace({material, kind}, parts_.size());
        if (is_new) {
            const auto [number, unseen] = material_of_.try_emplace(material, std::uint32_t(tree_.materials.size()));
            if (unseen)
                tree_.materials.push_back(tree_material(scene_.materials[std::size_t(material)],
                                                        color_factors_[std::size_t(material)], tree_.notes));
            parts_.emplace_back().part.kind = kind;
            parts_.back().part.material = number->second;
        }
        return parts_[place->second];
    }

    /// A part of the tree for the time being, of what is needed to measure it.
    void show_shape(const SceneMesh& mesh, TreePartKind kind) {
        TreePart& part = tree_.parts.emplace_back();
        part.kind = kind;
        part.positions = mesh.positions;
        part.triangles = mesh.triangles;
    }

    void make_leaves() {
        for (const SceneMesh& mesh : foliage_)
            show_shape(mesh, TreePartKind::foliage);
        for (const SceneMesh& mesh : bark_)
            show_shape(mesh, TreePartKind::bark);
        crown_ = crown_radius(tree_);
        tree_.parts.clear();
        const FoundLeaves leaves = find_leaves(foliage_, scene_.materials, options_.leaf_size, crown_, progress_);
        for (std::size_t m = 0; m < foliage_.size(); ++m)
            part_of(foliage_[m].material, TreePartKind::foliage).append(foliage_[m], leaves.leaf_of[m], 0);
        for (const PartBuilder& builder : parts_)
            tree_.parts.push_back(builder.part);
        tree_.leaves = leaf_centres(tree_, leaves.count);
        tell(leaves);
    }

    void tell(const FoundLeaves& leaves) {
        if (options_.leaf_size > 0 && options_.leaf_size < 1e-3f * crown_)
            tree_.notes.push_back("the leaf size, " + length_text(options_.leaf_size) +
                                  ", is less than a thousandth of the crown's radius of " + length_text(crown_) +
                                  ": foliage falls apart into its triangles if that is not what leaves measure");
        if (leaves.count == 0)
            tree_.notes.push_back("no foliage was found: say which material or mesh it is");
        else
            tree_.notes.push_back(counted(leaves.count, "leaf", "leaves") +
                                  ": connected foliage, cut where it turns by more than 30 degrees or is larger than " +
                                  length_text(leaves.largest_radius_m) + " in radius");
        if (leaves.stalks > 0)
            tree_.notes.push_back(counted(leaves.stalks, "stalk was", "stalks were") + " joined to their leaves");
    }

    /// Branching, from what bark is wood.
    void find_wood() {
        std::set<std::string> objects;
        for (const SceneMesh& mesh : bark_) {
            part_of(mesh.material, TreePartKind::bark);
            const std::string& material = scene_.materials[std::size_t(mesh.material)].name;
            if (names_object(material)) // it takes part in the light, but no branch begins in it
                objects.insert(material);
            else
                show_shape(mesh, TreePartKind::bark);
        }
        for (const std::string& material : objects)
            tree_.notes.push_back("material '" + shown_name(material) + "' is no wood: its name");
        infer_branching(tree_);
    }

    /// Bark patches: about as long as the wood is thick around, but no smaller than a quarter of a leaf across, and
    /// turning by at most 45 degrees; on twigs that are no thicker around than a leaf is across, rings as large as a
    /// leaf.
    void cut_bark() {
        const NearestAxis nearest_axis(tree_.skeleton);
        const float leaf = mean_leaf_radius(tree_), least = std::max(0.005f * crown_, 0.25f * leaf);
        SurfacePatchLimits limits;
        limits.max_turn = 0.7854f;
        limits.keep_cards = false;
        const auto is_twig = [&](const AxisPlace& axis) {
            return axis.found && axis.distance <= 2 * axis.radius_m && kPi * axis.radius_m <= leaf;
        };
        limits.whole_rings = [&](const glm::vec3& place) { return is_twig(nearest_axis.at(place)); };
        limits.max_radius = [&](const glm::vec3& place) {
            const AxisPlace nearest = nearest_axis.at(place);
            if (is_twig(nearest))
                return std::max(leaf, least);
            // A quarter of the circumference wide and as long as the circumference: an area of (2 pi r)^2 / 4.
            const float around =
                2 * kPi * (nearest.found ? std::max(nearest.radius_m, 0.2f * nearest.distance) : crown_);
            return std::max(0.5f * around / std::sqrt(kPi), least);
        };
        for (const SceneMesh& mesh : bark_) {
            const std::vector<std::uint32_t> patch = surface_patches(mesh.positions, mesh.triangles, limits);
            part_of(mesh.material, TreePartKind::bark).append(mesh, patch, tree_.bark_patch_count);
            tree_.bark_patch_count += patch_count(patch);
        }
    }

    MeshScene scene_;
    const ReadOptions& options_;
    Progress& progress_;
    Tree tree_;
    std::vector<SceneMesh> foliage_, bark_;
    std::vector<glm::vec3> color_factors_; ///< of each material: the mean of its vertices' colours
    std::vector<PartBuilder> parts_;
    std::map<std::pair<int, TreePartKind>, std::size_t> part_of_; ///< (material, kind)
    std::map<int, std::uint32_t> material_of_;                    ///< the file's -> the tree's
    float crown_ = 0;                                             ///< radius, metres
};

} // namespace

Tree tree_from_scene(MeshScene scene, const std::string& path, const ReadOptions& options, Progress& progress) {
    return ForeignTreeBuilder(std::move(scene), path, options, progress).build();
}

} // namespace kokage
