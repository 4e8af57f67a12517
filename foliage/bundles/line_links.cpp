#include "common/services/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "foliage/bundles/line_links.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "foliage/bundles/line_links.h"

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace kokage::bundles::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using KeyTag = hn::CappedTag<std::uint32_t, FragmentLists::kGroup>;
constexpr std::size_t kGroup = FragmentLists::kGroup;

/// Writes pairs of sides behind `a` and `b`, which have room for a vector more than there are, and the sides that look
/// to the far ends of the lines (kInsideWood where a line is empty). Returns the number of pairs.
std::size_t LinkGroup(const FragmentLists& lists, std::size_t group, std::uint32_t face_mask,
                      const std::uint32_t* near_sides, Side first_bark_side, std::uint32_t* a, std::uint32_t* b,
                      std::uint32_t* far_ends) {
    const KeyTag d;
    const hn::RebindToSigned<KeyTag> di;
    const auto inside_wood = hn::Set(d, FacingSide::kInsideWood);
    const std::uint32_t first = lists.group_row[group], rows = lists.group_row[group + 1] - first;
    std::size_t count = 0;
    for (std::size_t k = 0; k < kGroup; k += hn::Lanes(d)) {
        const std::uint32_t* keys = lists.keys.data() + std::size_t(first) * kGroup + k;
        const auto ends = hn::LoadU(d, lists.list_end.data() + group * kGroup + k);
        const auto length = hn::Sub(hn::ShiftRight<4>(ends), hn::Set(d, first));
        auto open = inside_wood; // looks at the next face
        for (std::uint32_t i = 0; i < rows; ++i) {
            const auto there = hn::Lt(hn::Set(d, i), length);
            const auto face = hn::And(hn::LoadU(d, keys + i * kGroup), hn::Set(d, face_mask));
            const auto near = hn::GatherIndex(d, near_sides, hn::BitCast(di, hn::IfThenElseZero(there, face)));
            if (i > 0) {
                const auto seen = hn::And(there, hn::Lt(hn::And(open, near), inside_wood));
                hn::StoreU(hn::Compress(open, seen), d, a + count);
                hn::StoreU(hn::Compress(near, seen), d, b + count);
                count += hn::CountTrue(d, seen);
            }
            // The other side; the other side of bark is inside the wood, and the other way round.
            const auto leaf = hn::Lt(hn::AndNot(inside_wood, near), hn::Set(d, first_bark_side));
            const auto far = hn::Xor(near, hn::Xor(hn::Set(d, 1u), hn::IfThenZeroElse(leaf, inside_wood)));
            open = hn::IfThenElse(there, far, open);
        }
        hn::StoreU(open, d, far_ends + k);
    }
    return count;
}

std::size_t LinkGroups(const FragmentLists& lists, std::size_t first, std::size_t last, std::uint32_t face_mask,
                       const std::uint32_t* near_sides, Side first_bark_side, std::uint32_t* a, std::uint32_t* b,
                       std::uint32_t* far_ends) {
    std::size_t count = 0;
    for (std::size_t group = first; group < last; ++group) {
        std::uint32_t* ends = far_ends + (group - first) * kGroup;
        if (lists.group_row[group] == lists.group_row[group + 1])
            std::fill_n(ends, kGroup, std::uint32_t(FacingSide::kInsideWood));
        else
            count += LinkGroup(lists, group, face_mask, near_sides, first_bark_side, a + count, b + count, ends);
    }
    return count;
}

} // namespace kokage::bundles::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kokage::bundles {

HWY_EXPORT(LinkGroups);

GroundProjection project_to_ground(const GroundGrid& grid, const Projection& projection) {
    const glm::vec3& d = projection.direction;
    if (d.y > -1e-3f) // lines this flat leave the grid
        return {};
    auto point = [&](float u, float v) {
        const glm::vec3 on_plane =
            ((u - projection.offset.x) * projection.u_axis + (v - projection.offset.y) * projection.v_axis) /
            projection.pixels_per_unit;
        const glm::vec3 hit = on_plane + d * ((grid.height - on_plane.y) / d.y);
        return glm::vec2(hit.x, hit.z);
    };
    const glm::vec2 origin = point(0, 0);
    return {origin, point(1, 0) - origin, point(0, 1) - origin, true};
}

LeafPlanes leaf_planes(const Facets& facets) {
    LeafPlanes leaves;
    const std::size_t count = facets.leaf_facet_count;
    for (auto* axis : {&leaves.normal_x, &leaves.normal_y, &leaves.normal_z})
        axis->resize(count);
    leaves.front.resize(count);
    for (std::size_t f = 0; f < count; ++f) {
        const Facet& facet = facets.facets[f];
        leaves.normal_x[f] = facet.normal.x;
        leaves.normal_y[f] = facet.normal.y;
        leaves.normal_z[f] = facet.normal.z;
        leaves.front[f] = 2 * facet.patch;
    }
    return leaves;
}

void near_sides(const Facets& facets, const LeafPlanes& leaves, const glm::vec3& direction,
                std::vector<std::uint32_t>& sides) {
    sides.resize(facets.face_count());
    for (std::size_t f = 0; f < facets.leaf_facet_count; ++f) {
        const float facing =
            leaves.normal_x[f] * direction.x + leaves.normal_y[f] * direction.y + leaves.normal_z[f] * direction.z;
        sides[f] = leaves.front[f] + std::uint32_t(facing >= 0);
    }
    for (std::size_t f = facets.leaf_facet_count, face = f; f < facets.facets.size(); ++f, face += 2) {
        const Side front = 2 * facets.facets[f].patch;
        sides[face] = front;
        sides[face + 1] = (front + 1) | FacingSide::kInsideWood;
    }
}

void collect_links(const RasterScratch& raster, const Facets& facets, const Projection& projection,
                   const std::vector<std::uint32_t>& sides, const std::optional<GroundGrid>& ground,
                   std::uint32_t phase, DirectionLinks& out) {
    constexpr std::size_t group = FragmentLists::kGroup;
    const std::uint32_t face_mask = (1u << face_bits(facets)) - 1;
    const bool bark = facets.leaf_facet_count < facets.facets.size();
    const Side first_bark_side = bark ? 2 * facets.facets[facets.leaf_facet_count].patch : FacingSide::kInsideWood - 1;
    const GroundProjection on_ground = ground ? project_to_ground(*ground, projection) : GroundProjection{};
    out.a.resize(raster.fragment_count + group);
    out.b.resize(raster.fragment_count + group);
    std::size_t count = 0;
    const std::size_t width = std::size_t(projection.width);
    std::vector<std::uint32_t> far_ends(width);
    for (std::size_t y = 0; y < std::size_t(projection.height); ++y) {
        const std::size_t first = y * width / group;
        if (raster.lists.group_row[first] == raster.lists.group_row[first + width / group])
            continue;
        count += HWY_DYNAMIC_DISPATCH(LinkGroups)(raster.lists, first, first + width / group, face_mask, sides.data(),
                                                  first_bark_side, out.a.data() + count, out.b.data() + count,
                                                  far_ends.data());
        constexpr std::size_t stride = GroundGrid::kStride;
        if (!on_ground.valid || (y + phase / stride) % stride != 0)
            continue;
        for (std::size_t x = (stride - phase % stride) % stride; x < width; x += stride) {
            const FacingSide open{far_ends[x]};
            if (open.inside_wood())
                continue;
            const glm::vec2 hit = on_ground.origin + float(x) * on_ground.along_u + float(y) * on_ground.along_v;
            if (const int texel = ground->texel_at(hit.x, hit.y); texel >= 0)
                out.ground.push_back({open.side(), std::uint32_t(texel)});
        }
    }
    out.a.resize(count);
    out.b.resize(count);
}

} // namespace kokage::bundles
#endif
