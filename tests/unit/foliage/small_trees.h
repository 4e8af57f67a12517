#pragma once
// Small trees for tests of placement and of the methods that use light maps.
#include "common/environment/environment.h"
#include "tests/unit/common/scene_builders.h"
#include "trees/tree.h"

namespace kokage::test {

inline std::int32_t add_branch(Skeleton& skeleton, std::int32_t parent, const glm::vec3& start, const glm::vec3& end,
                               float radius = 0.01f) {
    Branch branch;
    branch.parent = parent;
    branch.order = parent < 0 ? 0 : skeleton.branches[std::size_t(parent)].order + 1;
    branch.nodes = {{start, radius}, {end, radius}};
    skeleton.branches.push_back(branch);
    return std::int32_t(skeleton.branches.size()) - 1;
}

struct SmallTree {
    PatchScene scene;
    Tree tree;
};

/// A ball of random leaves (see random_crown) on a made-up skeleton of orders 0 to 3: 6 limbs, 24 branches, 72 twigs. A
/// leaf is borne by the twig whose tip is nearest. No bark.
inline SmallTree ball_on_a_skeleton(std::uint32_t leaves, float area_index, const Optics& optics,
                                    std::uint64_t seed = 1) {
    SmallTree result;
    result.scene = random_crown(leaves, area_index, optics, seed);
    Skeleton& skeleton = result.tree.skeleton;
    Random random(seed, 7);
    const glm::vec3 centre(0, 2, 0);
    const std::int32_t trunk = add_branch(skeleton, -1, {0, 0, 0}, {0, 2.5f, 0}, 0.03f);
    for (int i = 0; i < 6; ++i) {
        const glm::vec3 fork(0, 1.2f + 0.2f * float(i), 0), limb_tip = centre + 0.6f * random_direction(random);
        const std::int32_t limb = add_branch(skeleton, trunk, fork, limb_tip, 0.02f);
        for (int j = 0; j < 4; ++j) {
            const glm::vec3 base = glm::mix(fork, limb_tip, 0.4f + 0.2f * float(j));
            const glm::vec3 branch_tip = base + 0.4f * random_direction(random);
            const std::int32_t branch = add_branch(skeleton, limb, base, branch_tip);
            for (int k = 0; k < 3; ++k) {
                const glm::vec3 start = glm::mix(base, branch_tip, 0.5f + 0.25f * float(k));
                add_branch(skeleton, branch, start, start + 0.3f * random_direction(random), 0.005f);
            }
        }
    }
    for (const Patch& patch : result.scene.patches) {
        Leaf leaf;
        glm::vec3 sum{0.f};
        for (std::uint32_t t = 0; t < patch.triangle_count; ++t)
            for (std::size_t c = 0; c < 3; ++c)
                sum += result.scene.positions[result.scene.triangles[patch.first_triangle + t][c]];
        leaf.centre = sum / float(3 * patch.triangle_count);
        float nearest = 1e30f;
        for (std::size_t b = 0; b < skeleton.branches.size(); ++b)
            if (skeleton.branches[b].order == 3)
                if (const float d = glm::distance(skeleton.branches[b].nodes.back().position, leaf.centre);
                    d < nearest) {
                    nearest = d;
                    leaf.branch = std::int32_t(b);
                }
        result.tree.leaves.push_back(leaf);
    }
    return result;
}

/// Adds leaves that no tree should have: twenty in the same place, twenty without an area; half of all without a
/// branch.
inline void add_coincident_and_empty_leaves(SmallTree& small) {
    for (int copy = 0; copy < 20; ++copy) {
        add_rectangle(small.scene, {0, 2, 0}, {0.1f, 0, 0}, {0, 0, 0.1f});
        add_rectangle(small.scene, {0, 2, 0}, {0, 0, 0}, {0, 0, 0.1f});
        small.tree.leaves.push_back({{0, 2, 0}, -1});
        small.tree.leaves.push_back({{0, 2, 0}, 3});
    }
}

/// A blue sky that is brighter above, and a sun of 0.27 degrees.
inline Environment sky_and_sun() {
    Environment environment;
    environment.remainder = Image(64, 32, 3);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 64; ++x) {
            const float height = std::cos(kPi * (float(y) + 0.5f) / 32);
            const glm::vec3 radiance = glm::vec3(0.4f, 0.6f, 1.f) * (0.6f + 0.5f * height);
            for (std::size_t c = 0; c < 3; ++c)
                environment.remainder.at(x, y)[c] = radiance[c];
        }
    DistantLight sun;
    sun.name = "sun";
    sun.direction = glm::normalize(glm::vec3(1, 2, 0.5f));
    sun.half_angle = 0.0047f;
    sun.irradiance = {10, 9, 8};
    environment.distant_lights.push_back(sun);
    return environment;
}

/// The same light from above the horizon alone.
inline Environment upper_sky_and_sun() {
    Environment environment = sky_and_sun();
    for (int y = 16; y < 32; ++y)
        std::fill(environment.remainder.at(0, y), environment.remainder.at(0, y) + 3 * 64, 0.f);
    return environment;
}

inline Optics realistic_leaf() {
    return {{0.10f, 0.25f, 0.06f}, {0.08f, 0.25f, 0.04f}};
}
inline Optics bright_leaf() {
    return {glm::vec3(0.5f), glm::vec3(0.4f)};
}
inline Optics grey_leaf(float albedo) {
    return {glm::vec3(0.6f * albedo), glm::vec3(0.4f * albedo)};
}

} // namespace kokage::test
