#include "trees/growth/leaves.h"

#include "common/services/parallel.h"
#include "common/services/random.h"
#include "trees/growth/directions.h"
#include "trees/growth/streams.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

struct Blade {
    glm::vec3 base, along, across, normal; ///< a right-handed frame: across x along = normal
    float length, width;
};

/// Where the j-th of a shoot's leaves sits and how it is turned.
Blade place_leaf(const Branch& branch, const Shoot& shoot, std::uint32_t j, const GrowthParameters& p,
                 const glm::vec3& crown_centre) {
    Random random(p.seed, streams::of(streams::leaf, shoot.first_leaf + j));
    // Leaves crowd at the shoot's end: most spiral there, a few stand lower down.
    const float u = (float(j) + random.uniform(0.2f, 0.8f)) / float(shoot.leaf_count);
    const float at = 1 - 0.72f * std::pow(1 - u, 1.7f);
    const std::size_t first = shoot.first_node, last = branch.nodes.size() - 1;
    const float place = float(first) + at * float(last - first);
    const std::size_t node = std::min(std::size_t(place), last > first ? last - 1 : last);
    const std::size_t next = std::min(node + 1, last);
    const glm::vec3 a = branch.nodes[node].position, b = branch.nodes[next].position;
    const glm::vec3 axis = unit_or(b - a, {0, 1, 0});
    Blade blade;
    blade.base = a + (place - float(node)) * (b - a);
    // 2/5 phyllotaxis: 144 degrees from leaf to leaf.
    const float azimuth =
        2.51327412f * float(j) + float(hash64(shoot.first_leaf) % 6283) * 0.001f + random.uniform(-0.4f, 0.4f);
    const float angle = radians(80) - radians(42) * at + random.uniform(-0.3f, 0.3f);
    const glm::vec3 out = tilted(axis, angle, azimuth);
    const glm::vec3 away = unit_or(blade.base - crown_centre, {0, 1, 0});
    blade.along = unit_or(out + 0.2f * away + glm::vec3(0, -0.12f, 0), out);
    // The upper side turns to the light: up, and out of the crown.
    const glm::vec3 light =
        float(p.leaf_up) * (glm::vec3(0, 0.75f, 0) + 0.45f * away) + 0.35f * axis + 0.55f * random_direction(random);
    blade.across = unit_or(glm::cross(blade.along, light), any_perpendicular(blade.along));
    blade.normal = glm::cross(blade.across, blade.along);
    blade.length = float(p.leaf_length) * (1 + float(p.leaf_length_spread) * random.uniform(-1.f, 1.f));
    blade.width = blade.length * float(p.leaf_width);
    return blade;
}

} // namespace

void make_leaves(const GrownSkeleton& grown, const GrowthParameters& p, const glm::vec3& crown_centre, TreePart& part,
                 std::vector<Leaf>& leaves) {
    static const LeafShape card{{{-0.5f, 0}, {0.5f, 0}, {0.5f, 1}, {-0.5f, 1}}, {{0, 1, 2}, {0, 2, 3}}};
    const LeafShape& shape = p.leaf_form == LeafForm::alpha ? card : leaf_shape(p.leaf_detail);
    // A fold along the midrib; the card stays flat, because its two triangles do not share the midrib.
    const float fold = p.leaf_form == LeafForm::alpha ? 0.f : radians(p.leaf_fold);
    const std::size_t corners = shape.outline.size(), faces = shape.triangles.size(), count = std::size_t(p.leaves);
    part.kind = TreePartKind::foliage;
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
                const Blade blade = place_leaf(branch, shoot, j, p, crown_centre);
                for (std::size_t k = 0; k < corners; ++k) {
                    const glm::vec2 q = shape.outline[k];
                    const float side = q.x > 0 ? 1.f : q.x < 0 ? -1.f : 0.f, x = q.x * blade.width;
                    part.positions[leaf * corners + k] = blade.base + q.y * blade.length * blade.along +
                                                         x * std::cos(fold) * blade.across +
                                                         std::abs(x) * std::sin(fold) * blade.normal;
                    part.normals[leaf * corners + k] =
                        side == 0 ? blade.normal : std::cos(fold) * blade.normal - side * std::sin(fold) * blade.across;
                    part.uvs[leaf * corners + k] = {q.x + 0.5f, 1 - q.y};
                }
                glm::dvec3 centre(0.0);
                double area = 0;
                for (std::size_t f = 0; f < faces; ++f) {
                    const glm::uvec3 t = shape.triangles[f] + glm::uvec3(std::uint32_t(leaf * corners));
                    part.triangles[leaf * faces + f] = t;
                    part.triangle_patch[leaf * faces + f] = std::uint32_t(leaf);
                    const glm::dvec3 a(part.positions[t.x]), b(part.positions[t.y]), c(part.positions[t.z]);
                    const double weight = glm::length(glm::cross(b - a, c - a));
                    centre += weight * (a + b + c) / 3.0;
                    area += weight;
                }
                leaves[leaf].centre = glm::vec3(centre / area);
                leaves[leaf].branch = shoot.branch;
            }
        }
    });
}

} // namespace kokage
