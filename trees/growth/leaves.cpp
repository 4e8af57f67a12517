#include "trees/growth/leaves.h"

#include "common/services/parallel.h"
#include "common/services/random.h"
#include "trees/growth/directions.h"
#include "trees/growth/leaf_shape.h"
#include "trees/growth/streams.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

/// Where a leaf's stalk begins and how it is turned: a right-handed frame, across x along = normal.
struct LeafPlace {
    glm::vec3 foot, along, across, normal;
    float length;
};

/// A direction at `angle` from `axis`, at `azimuth` from the level plane that the axis lies in.
glm::vec3 tilted_from_level(const glm::vec3& axis, float angle, float azimuth) {
    const glm::vec3 level = unit_or(glm::cross(glm::vec3(0, 1, 0), axis), {1, 0, 0}), up = glm::cross(axis, level);
    return std::cos(angle) * axis + std::sin(angle) * (std::cos(azimuth) * level + std::sin(azimuth) * up);
}

/// Where the j-th of a shoot's leaves sits and how it is turned.
LeafPlace place_leaf(const Branch& branch, const Shoot& shoot, std::uint32_t j, const GrowthParameters& p,
                     const glm::vec3& crown_centre) {
    Random random(p.seed, streams::of(streams::leaf, shoot.first_leaf + j));
    const bool one_by_one =
        p.leaf_arrangement == LeafArrangement::spiral || p.leaf_arrangement == LeafArrangement::distichous;
    // Leaves crowd at the shoot's end: most stand there, a few lower down.
    const float nodes = float(leaf_node(p.leaf_arrangement, shoot.leaf_count - 1) + 1);
    const float within = one_by_one ? random.uniform(0.2f, 0.8f) : 0.5f;
    const float u = (float(leaf_node(p.leaf_arrangement, j)) + within) / nodes;
    const float crowding = float(p.leaf_crowding);
    const float at = 1 - (1 - 0.28f * crowding) * std::pow(1 - u, 1 + 0.7f * crowding);
    const std::size_t first = shoot.first_node, last = branch.nodes.size() - 1;
    const float place = float(first) + at * float(last - first);
    const std::size_t node = std::min(std::size_t(place), last > first ? last - 1 : last);
    const std::size_t next = std::min(node + 1, last);
    const glm::vec3 a = branch.nodes[node].position, b = branch.nodes[next].position;
    const glm::vec3 axis = unit_or(b - a, {0, 1, 0});
    LeafPlace leaf;
    leaf.foot = a + (place - float(node)) * (b - a);
    const bool level = p.leaf_arrangement == LeafArrangement::distichous;
    const float start = level ? 0.f : float(hash64(shoot.first_leaf) % 6283) * 0.001f;
    const float azimuth = start + leaf_azimuth(p.leaf_arrangement, j) + random.uniform(-0.4f, 0.4f);
    const float angle = std::max(0.f, radians(p.leaf_angle + 21) - radians(42) * at + random.uniform(-0.3f, 0.3f));
    glm::vec3 out = level ? tilted_from_level(axis, angle, azimuth) : tilted(axis, angle, azimuth);
    if (has_needles(p.leaf_shape) && j + 1 == shoot.leaf_count)
        out = axis; // the last spray is the shoot's own end
    const glm::vec3 away = unit_or(leaf.foot - crown_centre, {0, 1, 0});
    const glm::vec3 standing = unit_or(out + 0.2f * away + glm::vec3(0, -0.12f, 0), out);
    const float hang = float(p.leaf_hang);
    leaf.along = unit_or((1 - hang) * standing + hang * glm::vec3(0, -1, 0), standing);
    // Leaves that hang near the ground lie on it.
    const float reach = float(p.leaf_length * (1 + p.leaf_length_spread) * (1 + p.petiole_length));
    if (leaf.foot.y >= 0 && leaf.foot.y + reach * leaf.along.y < 0) {
        const float down = -leaf.foot.y / reach;
        const glm::vec3 sideways = unit_or({leaf.along.x, 0, leaf.along.z}, unit_or({away.x, 0, away.z}, {1, 0, 0}));
        leaf.along = glm::vec3(0, down, 0) + std::sqrt(1 - down * down) * sideways;
    }
    // The upper side turns to the light: up, and out of the crown.
    const glm::vec3 light =
        float(p.leaf_up) * (glm::vec3(0, 0.75f, 0) + 0.45f * away) + 0.35f * axis + 0.55f * random_direction(random);
    leaf.across = unit_or(glm::cross(leaf.along, light), any_perpendicular(leaf.along));
    leaf.normal = glm::cross(leaf.across, leaf.along);
    leaf.length = float(p.leaf_length) * (1 + float(p.leaf_length_spread) * random.uniform(-1.f, 1.f));
    return leaf;
}

} // namespace

float leaf_azimuth(LeafArrangement arrangement, std::uint32_t j) {
    switch (arrangement) {
    case LeafArrangement::opposite:
        return kPi * float(j % 2) + 0.5f * kPi * float(j / 2 % 2);
    case LeafArrangement::whorled:
        return 2 * kPi / 5 * (float(j % 5) + 0.5f * float(j / 5 % 2));
    case LeafArrangement::distichous:
        return kPi * float(j % 2);
    default:
        return 0.8f * kPi * float(j); // 2/5 of a turn
    }
}

std::uint32_t leaf_node(LeafArrangement arrangement, std::uint32_t j) {
    return arrangement == LeafArrangement::opposite ? j / 2 : arrangement == LeafArrangement::whorled ? j / 5 : j;
}

void make_leaves(const GrownSkeleton& grown, const GrowthParameters& p, const glm::vec3& crown_centre, TreePart& part,
                 std::vector<Leaf>& leaves) {
    part.kind = TreePartKind::foliage;
    if (is_bare(p))
        return;
    const LeafShape shape = leaf_shape(p);
    const std::size_t corners = shape.positions.size(), faces = shape.triangles.size(), count = std::size_t(p.leaves);
    // The centre is the same place in every leaf.
    glm::dvec3 centre(0.0);
    double area = 0;
    for (const glm::uvec3& t : shape.triangles) {
        const glm::dvec3 a(shape.positions[t.x]), b(shape.positions[t.y]), c(shape.positions[t.z]);
        const double weight = glm::length(glm::cross(b - a, c - a));
        centre += weight * (a + b + c) / 3.0;
        area += weight;
    }
    centre /= area;
    part.positions.resize(count * corners);
    part.normals.resize(count * corners);
    part.uvs.resize(count * corners);
    part.triangles.resize(count * faces);
    part.triangle_patch.resize(count * faces);
    leaves.resize(count);
    parallel_blocks(grown.shoots.size(), 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t s = begin; s < end; ++s) {
            const Shoot& shoot = grown.shoots[s];
            const Branch& branch = grown.skeleton.branches[std::size_t(shoot.branch)];
            for (std::uint32_t j = 0; j < shoot.leaf_count; ++j) {
                const std::size_t leaf = shoot.first_leaf + j;
                const LeafPlace place = place_leaf(branch, shoot, j, p, crown_centre);
                const glm::mat3 turn(place.across, place.along, place.normal);
                for (std::size_t k = 0; k < corners; ++k) {
                    part.positions[leaf * corners + k] = place.foot + place.length * (turn * shape.positions[k]);
                    part.normals[leaf * corners + k] = turn * shape.normals[k];
                    part.uvs[leaf * corners + k] = shape.uvs[k];
                }
                for (std::size_t f = 0; f < faces; ++f) {
                    part.triangles[leaf * faces + f] = shape.triangles[f] + glm::uvec3(std::uint32_t(leaf * corners));
                    part.triangle_patch[leaf * faces + f] = std::uint32_t(leaf);
                }
                leaves[leaf].centre = place.foot + place.length * (turn * glm::vec3(centre));
                leaves[leaf].branch = shoot.branch;
            }
        }
    });
}

} // namespace kokage
