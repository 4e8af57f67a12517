#include "trees/merge_trees.h"

#include "common/services/error.h"
#include "common/services/named_file.h"

#include <cmath>
#include <limits>

namespace kokage {
namespace {

class Placed {
  public:
    Placed(const TreePlacement& placement, const glm::dvec3& origin)
        : placement_(placement), sine_(std::sin(placement.turn_degrees * kPiDouble / 180)),
          cosine_(std::cos(placement.turn_degrees * kPiDouble / 180)), moved_(placement.at - origin) {}

    glm::dvec3 direction(const glm::dvec3& d) const {
        return {cosine_ * d.x + sine_ * d.z, d.y, cosine_ * d.z - sine_ * d.x};
    }
    glm::dvec3 point(const glm::dvec3& p) const { return direction(placement_.size * (p - placement_.foot)) + moved_; }
    glm::vec3 point(const glm::vec3& p) const { return glm::vec3(point(glm::dvec3(p))); }

  private:
    const TreePlacement& placement_;
    double sine_, cosine_;
    glm::dvec3 moved_;
};

void add_skeleton(Skeleton& all, const Skeleton& skeleton, const Placed& placed, double size) {
    const auto first = std::int32_t(all.branches.size());
    for (Branch branch : skeleton.branches) {
        if (branch.parent >= 0)
            branch.parent += first;
        for (Branch::Node& node : branch.nodes)
            node = {placed.point(node.position), float(double(node.radius_m) * size)};
        all.branches.push_back(std::move(branch));
    }
}

TreePart placed_part(TreePart part, const Placed& placed) {
    for (glm::vec3& position : part.positions)
        position = placed.point(position);
    for (glm::vec3& normal : part.normals)
        normal = glm::vec3(placed.direction(glm::dvec3(normal)));
    return part;
}

std::size_t vertices_of(const Tree& tree) {
    std::size_t count = 0;
    for (const TreePart& part : tree.parts)
        count += part.positions.size();
    return count;
}

void check_counts(const Tree& all, const Tree& tree) {
    constexpr std::size_t kMost = std::size_t(std::numeric_limits<std::int32_t>::max());
    for (const std::size_t sum :
         {all.leaves.size() + tree.leaves.size(), std::size_t(all.bark_patch_count) + tree.bark_patch_count,
          vertices_of(all) + vertices_of(tree), all.skeleton.branches.size() + tree.skeleton.branches.size()})
        if (sum > kMost)
            throw InputError("'" + shown_name(tree.name) + "': with it the scene has " + std::to_string(sum) +
                             " leaves, vertices or branches, more than can be numbered; take fewer or smaller trees");
}

} // namespace

glm::dvec3 placed_direction(const TreePlacement& placement, const glm::dvec3& direction) {
    return Placed(placement, glm::dvec3(0.0)).direction(direction);
}

glm::dvec3 placed_point(const TreePlacement& placement, const glm::dvec3& point, const glm::dvec3& origin) {
    return Placed(placement, origin).point(point);
}

void add_tree(Tree& all, const Tree& tree, const TreePlacement& placement, const MaterialNumbers& materials) {
    check_counts(all, tree);
    const Placed placed(placement, all.origin);
    const auto first_leaf = std::uint32_t(all.leaves.size());
    const auto first_branch = std::int32_t(all.skeleton.branches.size());
    add_skeleton(all.skeleton, tree.skeleton, placed, placement.size);
    for (const TreePart& part : tree.parts) {
        const std::vector<std::uint32_t>& numbers =
            part.kind == TreePartKind::foliage ? materials.foliage : materials.bark;
        if (part.material >= numbers.size())
            throw InputError("'" + shown_name(tree.name) + "': a part names material " + std::to_string(part.material) +
                             " of " + std::to_string(numbers.size()));
        TreePart& added = all.parts.emplace_back(placed_part(part, placed));
        added.material = numbers[part.material];
        const std::uint32_t first = part.kind == TreePartKind::foliage ? first_leaf : all.bark_patch_count;
        for (std::uint32_t& patch : added.triangle_patch)
            patch += first;
    }
    for (Leaf leaf : tree.leaves) {
        leaf.centre = placed.point(leaf.centre);
        if (leaf.branch >= 0)
            leaf.branch += first_branch;
        all.leaves.push_back(leaf);
    }
    all.bark_patch_count += tree.bark_patch_count;
    all.branching_known = all.branching_known && tree.branching_known;
    all.was_shaded = all.was_shaded || tree.was_shaded;
}

} // namespace kokage
