#include "trees/levels_of_detail.h"

#include "common/geometry/point_tree.h"
#include "common/services/error.h"
#include "trees/coarse_bark.h"
#include "trees/patches.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kokage {
namespace {

/// What grouping needs to know of a leaf.
struct LeafFacts {
    std::size_t part = 0, first_triangle = 0, triangle_count = 0;
    double area = 0;        ///< holes taken out
    glm::dvec3 centre{0.0}; ///< area centroid of its triangles
    glm::dvec3 normal{0.0}; ///< sum of its triangles' normals times area
};

std::vector<LeafFacts> facts_of_leaves(const Tree& tree, const std::vector<double>& solid_areas) {
    std::vector<LeafFacts> leaves(tree.leaves.size());
    for (std::size_t p = 0; p < tree.parts.size(); ++p) {
        const TreePart& part = tree.parts[p];
        if (part.kind != TreePartKind::foliage)
            continue;
        for (std::size_t t = 0; t < part.triangles.size(); ++t) {
            LeafFacts& leaf = leaves[part.triangle_patch[t]];
            if (leaf.triangle_count++ == 0) {
                leaf.part = p;
                leaf.first_triangle = t;
            }
            const glm::dvec3 a(part.positions[part.triangles[t].x]), b(part.positions[part.triangles[t].y]),
                c(part.positions[part.triangles[t].z]);
            const glm::dvec3 normal = 0.5 * glm::cross(b - a, c - a);
            leaf.normal += normal;
            leaf.centre += glm::length(normal) * (a + b + c) / 3.0;
            leaf.area += glm::length(normal);
        }
    }
    for (std::size_t i = 0; i < leaves.size(); ++i) {
        leaves[i].centre = leaves[i].area > 0 ? leaves[i].centre / leaves[i].area : glm::dvec3(tree.leaves[i].centre);
        leaves[i].area = solid_areas[i];
    }
    return leaves;
}

/// Halves a range of leaves across its longest extent, in whole groups, until a group is left.
void gather(std::vector<std::uint32_t>& order, std::size_t begin, std::size_t end, std::size_t group,
            const std::vector<LeafFacts>& leaves, std::vector<std::size_t>& borders) {
    if (end - begin <= group) {
        borders.push_back(begin);
        return;
    }
    glm::dvec3 low(1e300), high(-1e300);
    for (std::size_t i = begin; i < end; ++i) {
        low = glm::min(low, leaves[order[i]].centre);
        high = glm::max(high, leaves[order[i]].centre);
    }
    const glm::dvec3 extent = high - low;
    const std::size_t axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    const std::size_t groups = (end - begin + group - 1) / group, middle = begin + groups / 2 * group;
    std::nth_element(order.begin() + std::ptrdiff_t(begin), order.begin() + std::ptrdiff_t(middle),
                     order.begin() + std::ptrdiff_t(end), [&](std::uint32_t a, std::uint32_t b) {
                         const double x = leaves[a].centre[axis], y = leaves[b].centre[axis];
                         return x != y ? x < y : a < b;
                     });
    gather(order, begin, middle, group, leaves, borders);
    gather(order, middle, end, group, leaves, borders);
}

/// Builds the level's foliage.
class CoarseLeaves {
  public:
    CoarseLeaves(const Tree& full, const std::vector<LeafFacts>& leaves, std::size_t group, LevelOfDetail& level)
        : full_(full), leaves_(leaves), level_(level) {
        for (std::size_t p = 0; p < full.parts.size(); ++p) {
            if (full.parts[p].kind != TreePartKind::foliage)
                continue;
            TreePart part;
            part.kind = TreePartKind::foliage;
            part.material = full.parts[p].material;
            std::vector<std::uint32_t> order;
            for (std::size_t i = 0; i < leaves.size(); ++i)
                if (leaves[i].triangle_count > 0 && leaves[i].part == p)
                    order.push_back(std::uint32_t(i));
            std::vector<std::size_t> borders;
            if (!order.empty())
                gather(order, 0, order.size(), group, leaves, borders);
            borders.push_back(order.size());
            for (std::size_t g = 0; g + 1 < borders.size(); ++g)
                add_leaf(std::span(order).subspan(borders[g], borders[g + 1] - borders[g]), part);
            level.tree.parts[p] = std::move(part);
        }
        // Leaves without a triangle have nothing to show: they stay with the first.
        for (std::size_t i = 0; i < leaves.size(); ++i)
            if (leaves[i].triangle_count == 0)
                level.stands_for[i] = level.tree.leaves.empty() ? ~0u : 0u;
    }

  private:
    void add_leaf(std::span<const std::uint32_t> group, TreePart& part) {
        const std::uint32_t number = std::uint32_t(level_.tree.leaves.size());
        double area = 0;
        glm::dvec3 centre(0.0), plain_centre(0.0);
        for (const std::uint32_t i : group) {
            area += leaves_[i].area;
            centre += leaves_[i].area * leaves_[i].centre;
            plain_centre += leaves_[i].centre / double(group.size());
        }
        centre = area > 0 ? centre / area : plain_centre;
        std::uint32_t chosen = group[0];
        double nearest = 1e300;
        for (const std::uint32_t i : group) {
            const double distance = glm::length(leaves_[i].centre - centre);
            if (leaves_[i].area > 0 && distance < nearest) {
                nearest = distance;
                chosen = i;
            }
        }
        const LeafFacts& model = leaves_[chosen];
        const double scale = model.area > 0 ? std::sqrt(area / model.area) : 1;
        copy_scaled(model, centre, scale, number, part);
        level_.tree.leaves.push_back({glm::vec3(centre), full_.leaves[chosen].branch});
        for (const std::uint32_t i : group) {
            level_.stands_for[i] = number;
            level_.turned[i] = glm::dot(leaves_[i].normal, model.normal) < 0;
        }
    }

    void copy_scaled(const LeafFacts& model, const glm::dvec3& centre, double scale, std::uint32_t number,
                     TreePart& part) const {
        const TreePart& from = full_.parts[model.part];
        std::vector<std::pair<std::uint32_t, std::uint32_t>> copied; // few: searched one by one
        for (std::size_t t = model.first_triangle; t < model.first_triangle + model.triangle_count; ++t) {
            glm::uvec3 corners = from.triangles[t];
            for (std::size_t c = 0; c < 3; ++c) {
                const std::uint32_t vertex = corners[c];
                const auto found =
                    std::find_if(copied.begin(), copied.end(), [&](const auto& pair) { return pair.first == vertex; });
                if (found != copied.end()) {
                    corners[c] = found->second;
                    continue;
                }
                corners[c] = std::uint32_t(part.positions.size());
                copied.emplace_back(vertex, corners[c]);
                part.positions.push_back(
                    glm::vec3(centre + scale * (glm::dvec3(from.positions[vertex]) - model.centre)));
                part.normals.push_back(from.normals[vertex]);
                if (!from.uvs.empty())
                    part.uvs.push_back(from.uvs[vertex]);
            }
            part.triangles.push_back(corners);
            part.triangle_patch.push_back(number);
        }
    }

    const Tree& full_;
    const std::vector<LeafFacts>& leaves_;
    LevelOfDetail& level_;
};

void add_bark(const Tree& full, int level, LevelOfDetail& result) {
    const std::size_t leaves = full.leaves.size();
    double share = 1;
    for (int k = 0; k < level; ++k)
        share /= detail_ratio;
    std::vector<const TreePart*> fine;
    std::vector<std::size_t> place;
    for (std::size_t p = 0; p < full.parts.size(); ++p)
        if (full.parts[p].kind == TreePartKind::bark) {
            fine.push_back(&full.parts[p]);
            place.push_back(p);
        }
    std::vector<CoarseBark> all = coarse_bark(fine, share, leaves == 0);
    for (std::size_t i = 0; i < all.size(); ++i) {
        CoarseBark& coarse = all[i];
        for (std::uint32_t& patch : coarse.part.triangle_patch)
            patch += result.tree.bark_patch_count;
        for (const auto& [patch, other] : coarse.stands_for)
            result.stands_for[leaves + patch] =
                other == ~0u ? ~0u : std::uint32_t(result.tree.leaves.size()) + result.tree.bark_patch_count + other;
        result.tree.bark_patch_count += coarse.patches;
        result.tree.parts[place[i]] = std::move(coarse.part);
    }
}

std::vector<double> areas_of(const Tree& tree) {
    return solid_areas(make_patches(tree));
}

} // namespace

LevelOfDetail level_of_detail(const Tree& full, int level) {
    if (level < 0 || level > 8)
        throw InputError("level of detail " + std::to_string(level) + ": 0 to 8 are possible");
    const std::vector<double> full_areas = areas_of(full);
    LevelOfDetail result;
    const std::size_t patches = full.leaves.size() + full.bark_patch_count;
    result.turned.assign(patches, 0);
    result.stands_for.resize(patches);
    std::iota(result.stands_for.begin(), result.stands_for.end(), 0u);
    result.tree = full;
    if (level > 0) {
        result.tree.name += ", level of detail " + std::to_string(level);
        result.tree.leaves.clear();
        result.tree.bark_patch_count = 0;
        std::size_t group = 1;
        for (int k = 0; k < level; ++k)
            group *= detail_ratio;
        CoarseLeaves(full, facts_of_leaves(full, full_areas), group, result);
        add_bark(full, level, result);
    }
    const std::vector<double> areas = level > 0 ? areas_of(result.tree) : full_areas;
    const auto border = areas.begin() + std::ptrdiff_t(result.tree.leaves.size());
    result.leaf_area = std::accumulate(areas.begin(), border, 0.0);
    result.bark_area = std::accumulate(border, areas.end(), 0.0);
    return result;
}

ShadedAttributes transfer_light(const Tree& full, const ShadedAttributes& light, const LevelOfDetail& level) {
    const std::size_t patches = full.leaves.size() + full.bark_patch_count;
    const bool has_indirect = !light.indirect_front.empty();
    if (light.radiance_front.size() != patches || light.radiance_back.size() != patches ||
        (has_indirect && (light.indirect_front.size() != patches || light.indirect_back.size() != patches)))
        throw InputError("light of " + std::to_string(light.radiance_front.size()) + " patches for a tree with " +
                         std::to_string(patches));
    if (level.stands_for.size() != patches || level.turned.size() != patches)
        throw InputError("a level of detail of another tree");
    const std::vector<double> areas = areas_of(full);
    const std::size_t count = level.tree.leaves.size() + level.tree.bark_patch_count;
    std::vector<double> weight(count, 0.0);
    for (std::size_t i = 0; i < patches; ++i)
        if (level.stands_for[i] != ~0u)
            weight[level.stands_for[i]] += areas[i];
    const auto means = [&](const std::vector<glm::vec3>& front, const std::vector<glm::vec3>& back,
                           std::vector<glm::vec3>& mean_front, std::vector<glm::vec3>& mean_back) {
        std::vector<glm::dvec3> front_sum(count, glm::dvec3(0.0)), back_sum(count, glm::dvec3(0.0));
        for (std::size_t i = 0; i < patches; ++i) {
            const std::uint32_t to = level.stands_for[i];
            if (to == ~0u || !(weight[to] > 0))
                continue;
            front_sum[to] += areas[i] / weight[to] * glm::dvec3(level.turned[i] ? back[i] : front[i]);
            back_sum[to] += areas[i] / weight[to] * glm::dvec3(level.turned[i] ? front[i] : back[i]);
        }
        mean_front.assign(front_sum.begin(), front_sum.end());
        mean_back.assign(back_sum.begin(), back_sum.end());
    };
    ShadedAttributes result;
    means(light.radiance_front, light.radiance_back, result.radiance_front, result.radiance_back);
    if (has_indirect)
        means(light.indirect_front, light.indirect_back, result.indirect_front, result.indirect_back);
    result.light_maps = light.light_maps;
    result.scale = light.scale;
    return result;
}

} // namespace kokage
