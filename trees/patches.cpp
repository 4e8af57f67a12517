#include "trees/patches.h"

#include "common/services/error.h"
#include "common/services/named_file.h"
#include "trees/leaf_subdivision.h"

#include <algorithm>
#include <map>
#include <string>

namespace kokage {
namespace {

/// A patch's triangles in the tree: consecutive in one part.
struct Run {
    std::uint32_t part = 0, first = 0, count = 0;
};

std::vector<Run> find_runs(const Tree& tree, TreePartKind kind, std::size_t count) {
    std::vector<Run> runs(count);
    for (std::uint32_t p = 0; p < tree.parts.size(); ++p) {
        const TreePart& part = tree.parts[p];
        if (part.kind != kind)
            continue;
        const char* name = kind == TreePartKind::foliage ? "leaf " : "bark patch ";
        if (part.triangle_patch.size() != part.triangles.size())
            throw InputError("tree '" + shown_name(tree.name) + "', part " + std::to_string(p) + ": " +
                             std::to_string(part.triangles.size()) + " triangles, but patch numbers for " +
                             std::to_string(part.triangle_patch.size()));
        for (std::uint32_t t = 0; t < part.triangles.size(); ++t) {
            const std::uint32_t index = part.triangle_patch[t];
            if (index >= count)
                throw InputError("tree '" + shown_name(tree.name) + "', part " + std::to_string(p) + ", triangle " +
                                 std::to_string(t) + ": " + name + std::to_string(index) + ", but there are only " +
                                 std::to_string(count));
            Run& run = runs[index];
            if (run.count == 0)
                run = {p, t, 0};
            if (run.part != p || run.first + run.count != t)
                throw InputError("tree '" + shown_name(tree.name) + "', part " + std::to_string(p) + ", triangle " +
                                 std::to_string(t) + ": the triangles of " + name + std::to_string(index) +
                                 " are not consecutive");
            ++run.count;
        }
    }
    return runs;
}

void check_indices(const Tree& tree) {
    for (std::size_t p = 0; p < tree.parts.size(); ++p) {
        const TreePart& part = tree.parts[p];
        const std::string where = "tree '" + shown_name(tree.name) + "', part " + std::to_string(p) + ": ";
        if (part.material >= tree.materials.size())
            throw InputError(where + "material " + std::to_string(part.material) + " of " +
                             std::to_string(tree.materials.size()));
        if (!part.uvs.empty() && part.uvs.size() != part.positions.size())
            throw InputError(where + std::to_string(part.uvs.size()) + " texture coordinates for " +
                             std::to_string(part.positions.size()) + " positions");
        for (const glm::uvec3& t : part.triangles)
            if (std::max({t.x, t.y, t.z}) >= part.positions.size())
                throw InputError(where + "a triangle names position " + std::to_string(std::max({t.x, t.y, t.z})) +
                                 " of " + std::to_string(part.positions.size()));
    }
}

/// Builds the scene piece by piece.
class Assembly {
  public:
    Assembly(const Tree& tree, const PatchOptions& options, PatchOrigins& origins)
        : tree_(tree), options_(options), origins_(origins) {
        bool any_uvs = false;
        for (const TreePart& part : tree.parts) {
            first_position_.push_back(std::uint32_t(scene.positions.size()));
            scene.positions.insert(scene.positions.end(), part.positions.begin(), part.positions.end());
            origins_.normals.insert(origins_.normals.end(), part.normals.begin(), part.normals.end());
            origins_.normals.resize(scene.positions.size(), glm::vec3(0, 1, 0));
            any_uvs = any_uvs || !part.uvs.empty();
        }
        if (any_uvs) {
            scene.uvs.reserve(scene.positions.size());
            for (std::size_t p = 0; p < tree.parts.size(); ++p) {
                scene.uvs.insert(scene.uvs.end(), tree.parts[p].uvs.begin(), tree.parts[p].uvs.end());
                scene.uvs.resize(first_position_[p] + tree.parts[p].positions.size(), glm::vec2(0.f));
            }
        }
        for (const TreePart& part : tree.parts)
            part_mask_.push_back(mask_of(part));
    }

    void add(const Run& run, PatchKind kind, std::uint32_t leaf) {
        if (run.count == 0) { // keeps the numbering; nothing to see
            scene.patches.push_back({std::uint32_t(scene.triangles.size()), 0, optics_index(0, kind), kind, leaf});
            return;
        }
        const TreePart& part = tree_.parts[run.part];
        const std::uint32_t optics = optics_index(part.material, kind);
        std::vector<glm::uvec3> triangles(part.triangles.begin() + run.first,
                                          part.triangles.begin() + run.first + run.count);
        for (glm::uvec3& t : triangles)
            t += glm::uvec3(first_position_[run.part]);
        if (kind == PatchKind::leaf && options_.leaf_subdivisions > 0) {
            for (const auto& piece : subdivide_leaf(std::move(triangles), options_.leaf_subdivisions,
                                                    {scene.positions, origins_.normals, scene.uvs}))
                append({0, 0, optics, kind, leaf}, piece, run.part);
        } else {
            append({0, 0, optics, kind, leaf}, triangles, run.part);
        }
    }

    PatchScene scene;

  private:
    void append(Patch patch, const std::vector<glm::uvec3>& triangles, std::uint32_t part) {
        patch.first_triangle = std::uint32_t(scene.triangles.size());
        patch.triangle_count = std::uint32_t(triangles.size());
        scene.patches.push_back(patch);
        scene.triangles.insert(scene.triangles.end(), triangles.begin(), triangles.end());
        scene.triangle_patch.resize(scene.triangles.size(), std::uint32_t(scene.patches.size() - 1));
        origins_.triangle_part.resize(scene.triangles.size(), part);
        if (!scene.masks.empty())
            scene.triangle_mask.resize(scene.triangles.size(), part_mask_[part]);
    }

    std::int16_t mask_of(const TreePart& part) {
        const TreeMaterial& material = tree_.materials[part.material];
        if (!material.alpha_texture || material.alpha_texture->empty() || part.uvs.empty())
            return -1;
        const auto found = material_mask_.find(part.material);
        if (found != material_mask_.end())
            return found->second;
        if (scene.masks.size() > 32766)
            throw InputError("tree '" + tree_.name + "': more than 32767 alpha masks; merge its materials");
        scene.masks.push_back({material.alpha_texture, material.alpha_cutoff, material.wrap_u, material.wrap_v});
        return material_mask_[part.material] = std::int16_t(scene.masks.size() - 1);
    }

    std::uint32_t optics_index(std::uint32_t material, PatchKind kind) {
        const auto [entry, is_new] = optics_index_.try_emplace({material, kind}, std::uint32_t(scene.optics.size()));
        if (is_new)
            scene.optics.push_back(optics(material, kind));
        return entry->second;
    }

    Optics optics(std::uint32_t material, PatchKind kind) const {
        if (kind == PatchKind::leaf && options_.leaf_optics)
            return *options_.leaf_optics;
        if (kind == PatchKind::bark && options_.bark_albedo)
            return {*options_.bark_albedo, glm::vec3(0.f)};
        if (material >= tree_.materials.size())
            return {};
        const TreePartKind part_kind = kind == PatchKind::leaf ? TreePartKind::foliage : TreePartKind::bark;
        return optics_of(tree_.materials[material], part_kind, mean_base_color(tree_, material, part_kind));
    }

    const Tree& tree_;
    const PatchOptions& options_;
    PatchOrigins& origins_;
    std::vector<std::uint32_t> first_position_;
    std::vector<std::int16_t> part_mask_;
    std::map<std::uint32_t, std::int16_t> material_mask_;
    std::map<std::pair<std::uint32_t, PatchKind>, std::uint32_t> optics_index_;
};

} // namespace

PatchScene make_patches(const Tree& tree, const PatchOptions& options, PatchOrigins* origins) {
    if (options.leaf_subdivisions < 0 || options.leaf_subdivisions > 6)
        throw InputError("leaf subdivisions: " + std::to_string(options.leaf_subdivisions) + "; 0 to 6 are possible");
    check_indices(tree);
    const std::vector<Run> leaves = find_runs(tree, TreePartKind::foliage, tree.leaves.size());
    const std::vector<Run> bark = find_runs(tree, TreePartKind::bark, tree.bark_patch_count);
    PatchOrigins own_origins;
    PatchOrigins& used_origins = origins ? *origins : own_origins;
    used_origins = {};
    Assembly assembly(tree, options, used_origins);
    assembly.scene.patches.reserve(leaves.size() + bark.size());
    for (std::uint32_t i = 0; i < leaves.size(); ++i)
        assembly.add(leaves[i], PatchKind::leaf, i);
    for (const Run& run : bark)
        assembly.add(run, PatchKind::bark, 0);
    assembly.scene.leaf_count = std::uint32_t(tree.leaves.size());
    assembly.scene.ground = options.ground;
    return std::move(assembly.scene);
}

} // namespace kokage
