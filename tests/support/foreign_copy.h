#pragma once
// A grown tree as a stranger's file would hold it: meshes and materials alone. For tests of what is found again.
#include "common/geometry/triangle_topology.h"
#include "common/services/random.h"
#include "trees/foreign_tree.h"
#include "trees/patches.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <numeric>

namespace kokage {

/// Fisher and Yates.
inline std::vector<std::uint32_t> shuffled(std::size_t count, Random& random) {
    std::vector<std::uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0u);
    for (std::size_t i = count; i-- > 1;)
        std::swap(order[i], order[random.below(std::uint32_t(i) + 1)]);
    return order;
}

inline SceneMaterial plain_material(const TreeMaterial& material) {
    SceneMaterial plain;
    plain.name = material.name;
    plain.base_color = glm::vec4(material.base_color, 1.f);
    plain.double_sided = material.double_sided;
    plain.roughness = material.roughness;
    if (material.diffuse_transmission >= 0) {
        plain.diffuse_transmission = material.diffuse_transmission;
        plain.diffuse_transmission_color = material.diffuse_transmission_color;
    }
    if (material.base_color_texture || material.alpha_texture) {
        SceneTexture texture;
        texture.color = material.base_color_texture;
        texture.alpha = material.alpha_texture;
        texture.wrap_u = material.wrap_u;
        texture.wrap_v = material.wrap_v;
        plain.base_color_texture = texture;
    }
    if (material.alpha_texture) {
        plain.alpha_mode = AlphaMode::mask;
        plain.alpha_cutoff = material.alpha_cutoff;
    }
    return plain;
}

/// No skeleton, no leaf or patch numbers; in each part all vertices at one place are one (where leaves need their
/// texture coordinates: at one place with the same ones), triangles and vertices stand in random order, and every
/// triangle begins at a random corner.
inline MeshScene foreign_copy(const Tree& tree, std::uint64_t seed) {
    Random random(seed);
    MeshScene scene;
    scene.origin = tree.origin;
    for (const TreeMaterial& material : tree.materials)
        scene.materials.push_back(plain_material(material));
    for (const TreePart& part : tree.parts) {
        std::vector<std::uint32_t> welded = weld(part.positions);
        if (part.kind == TreePartKind::foliage && tree.materials[part.material].alpha_texture) {
            std::map<std::array<float, 3>, std::uint32_t> first;
            for (std::uint32_t v = 0; v < welded.size(); ++v)
                welded[v] = first.try_emplace({float(welded[v]), part.uvs[v].x, part.uvs[v].y}, v).first->second;
        }
        SceneMesh mesh;
        mesh.material = int(part.material);
        mesh.mesh_index = int(scene.meshes.size());
        std::vector<std::uint32_t> place(part.positions.size(), ~0u);
        for (const std::uint32_t v : shuffled(part.positions.size(), random)) {
            if (welded[v] != v)
                continue;
            place[v] = std::uint32_t(mesh.positions.size());
            mesh.positions.push_back(part.positions[v]);
            mesh.normals.push_back(part.normals[v]);
            if (!part.uvs.empty())
                mesh.uvs.push_back(part.uvs[v]);
        }
        for (const std::uint32_t t : shuffled(part.triangles.size(), random)) {
            const glm::uvec3& corners = part.triangles[t];
            const std::uint32_t from = random.below(3);
            glm::uvec3 triangle;
            for (std::uint32_t c = 0; c < 3; ++c)
                triangle[int(c)] = place[welded[corners[int((c + from) % 3)]]];
            mesh.triangles.push_back(triangle);
        }
        scene.meshes.push_back(std::move(mesh));
    }
    return scene;
}

/// What is found again in a foreign copy.
inline Tree found_again(const Tree& tree, std::uint64_t seed, const ReadOptions& options = {}) {
    return tree_from_scene(foreign_copy(tree, seed), "foreign copy of " + tree.name, options, silent_progress());
}

/// A place as a key: triangles keep their corners' bits, whatever becomes of their order.
using TriangleKey = std::array<std::array<std::uint32_t, 3>, 3>;
inline TriangleKey triangle_key(const TreePart& part, const glm::uvec3& triangle) {
    TriangleKey key;
    for (int c = 0; c < 3; ++c) {
        const glm::vec3 place = part.positions[triangle[c]] + 0.f; // -0 becomes 0
        std::memcpy(key[std::size_t(c)].data(), &place, sizeof place);
    }
    std::sort(key.begin(), key.end());
    return key;
}

/// For every leaf of the found tree the leaf of the true one that most of its area is of.
inline std::vector<std::uint32_t> true_leaves(const Tree& truth, const Tree& found) {
    std::map<TriangleKey, std::uint32_t> leaf_of;
    for (const TreePart& part : truth.parts)
        if (part.kind == TreePartKind::foliage)
            for (std::size_t t = 0; t < part.triangles.size(); ++t)
                leaf_of[triangle_key(part, part.triangles[t])] = part.triangle_patch[t];
    std::vector<std::map<std::uint32_t, double>> areas(found.leaves.size());
    for (const TreePart& part : found.parts)
        if (part.kind == TreePartKind::foliage)
            for (std::size_t t = 0; t < part.triangles.size(); ++t)
                if (const auto leaf = leaf_of.find(triangle_key(part, part.triangles[t])); leaf != leaf_of.end()) {
                    const glm::uvec3& corners = part.triangles[t];
                    const glm::vec3 a = part.positions[corners.x];
                    areas[part.triangle_patch[t]][leaf->second] +=
                        double(glm::length(glm::cross(part.positions[corners.y] - a, part.positions[corners.z] - a)));
                }
    std::vector<std::uint32_t> leaves(found.leaves.size(), ~0u);
    for (std::size_t i = 0; i < leaves.size(); ++i) {
        double most = -1;
        for (const auto& [leaf, area] : areas[i])
            if (area > most) {
                most = area;
                leaves[i] = leaf;
            }
    }
    return leaves;
}

/// How well generations are found again. Of each branch of the true tree that bears leaves: the found order of the
/// branch that most of its leaves hang on (of a tie, the lowest branch).
struct GenerationAgreement {
    std::size_t bearing = 0;  ///< branches of the true tree that bear leaves (that were found again)
    std::size_t of_order = 0; ///< of them, those whose order is found right
    std::size_t alone = 0;    ///< of them, those whose found branch bears no other true branch's majority
    double share() const { return bearing > 0 ? double(of_order) / double(bearing) : 0; }
    std::map<std::pair<int, int>, std::size_t> orders; ///< (true, found) -> branches
};

inline GenerationAgreement compare_generations(const Tree& truth, const Tree& found) {
    const std::vector<std::uint32_t> leaf_of = true_leaves(truth, found);
    std::vector<std::map<std::int32_t, std::size_t>> votes(truth.skeleton.branches.size());
    for (std::size_t i = 0; i < leaf_of.size(); ++i)
        if (leaf_of[i] != ~0u)
            ++votes[std::size_t(truth.leaves[leaf_of[i]].branch)][found.leaves[i].branch];
    GenerationAgreement result;
    std::map<std::int32_t, std::size_t> taken;
    for (std::size_t b = 0; b < votes.size(); ++b) {
        if (votes[b].empty())
            continue;
        std::int32_t branch = -1;
        std::size_t most = 0;
        for (const auto& [candidate, count] : votes[b])
            if (count > most) {
                most = count;
                branch = candidate;
            }
        ++result.bearing;
        ++taken[branch];
        const int order = truth.skeleton.branches[b].order,
                  found_order = found.skeleton.branches[std::size_t(branch)].order;
        result.of_order += order == found_order;
        ++result.orders[{order, found_order}];
    }
    for (const auto& [branch, count] : taken)
        result.alone += count == 1;
    return result;
}

} // namespace kokage
