#include "common/services/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "foliage/bundles/end_gather.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include <hwy/contrib/math/math-inl.h>

#include "foliage/bundles/end_gather.h"

#include "common/services/parallel.h"

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace kokage::bundles::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::ScalableTag<float>;
using Vec = hn::Vec<FloatTag>;

/// What the kernels need of a block of facets, one array a quantity, padded to whole vectors.
struct FacetArrays {
    static constexpr std::size_t kBlock = 64;
    HWY_ALIGN float normal[3][kBlock]; // leaves
    HWY_ALIGN float form[6][kBlock];   // bark
    HWY_ALIGN float pixels[kBlock];    // that a facet covers head on
    HWY_ALIGN float masked[kBlock];    // 1 = has holes
    HWY_ALIGN std::uint8_t near_open[kBlock], far_open[kBlock];
    HWY_ALIGN float sums[11][kBlock];
};

/// Open share of a block's facets as floats, and zero weight where no line met them.
HWY_INLINE Vec Share(FloatTag d, const std::uint8_t* open) {
    const hn::Rebind<std::uint8_t, FloatTag> d8;
    const hn::RebindToSigned<FloatTag> di;
    return hn::ConvertTo(d, hn::PromoteTo(di, hn::LoadU(d8, open)));
}

enum class FacetKind { solid_leaf, any_leaf, bark };

/// Projected share over the chance that a line meets the facet; see EndSums.
template <FacetKind Kind>
HWY_INLINE Vec Weight(FloatTag d, Vec projected, const FacetArrays& block, std::size_t k) {
    const Vec pixels = hn::Load(d, block.pixels + k);
    const Vec solid = hn::Max(projected, hn::Div(hn::Set(d, 1.f), pixels));
    if constexpr (Kind != FacetKind::any_leaf)
        return solid;
    constexpr float kLeast = 1e-3f; // steeper ones are not drawn
    projected = hn::Max(projected, hn::Set(d, kLeast));
    const Vec covered = hn::Mul(projected, pixels);
    const Vec exponent = hn::MulAdd(hn::Mul(covered, covered), hn::Set(d, kNeedleClumping), covered);
    const Vec masked = hn::Div(projected, hn::Neg(hn::Expm1(d, hn::Neg(exponent))));
    return hn::IfThenElse(hn::Gt(hn::Load(d, block.masked + k), hn::Zero(d)), masked, solid);
}

template <FacetKind Kind>
void GatherBlock(FacetArrays& block, std::span<const glm::vec3> directions, const OpenFractions& open,
                 const EndRadiance& radiance, std::size_t first, std::size_t last, std::size_t facet,
                 std::size_t count) {
    const FloatTag d;
    const std::size_t lanes = hn::Lanes(d);
    const bool whole = facet + FacetArrays::kBlock <= open.facet_count;
    for (std::size_t i = first; i < last; ++i) {
        const std::uint8_t* near_open = open.near_row(i) + facet;
        const std::uint8_t* far_open = open.far_row(i) + facet;
        if (!whole) { // the last block may not read behind the row
            for (std::size_t k = 0; k < count; ++k) {
                block.near_open[k] = near_open[k];
                block.far_open[k] = far_open[k];
            }
            near_open = block.near_open;
            far_open = block.far_open;
        }
        const glm::vec3 direction = directions[i], near_light = radiance.near_end[i], far_light = radiance.far_end[i];
        const Vec dx = hn::Set(d, direction.x), dy = hn::Set(d, direction.y), dz = hn::Set(d, direction.z);
        for (std::size_t k = 0; k < count; k += lanes) {
            Vec near_share = Share(d, near_open + k), far_share = Share(d, far_open + k);
            const auto seen = hn::Lt(near_share, hn::Set(d, 254.5f));
            Vec weight;
            auto sum = [&](int quantity) { return block.sums[quantity] + k; };
            auto add = [&](int quantity, Vec value) {
                hn::Store(hn::Add(hn::Load(d, sum(quantity)), value), d, sum(quantity));
            };
            if constexpr (Kind == FacetKind::bark) {
                auto form = [&](int j) { return hn::Load(d, block.form[j] + k); };
                const Vec squares = hn::MulAdd(form(0), hn::Mul(dx, dx),
                                               hn::MulAdd(form(1), hn::Mul(dy, dy), hn::Mul(form(2), hn::Mul(dz, dz))));
                const Vec mixed = hn::MulAdd(form(3), hn::Mul(dx, dy),
                                             hn::MulAdd(form(4), hn::Mul(dx, dz), hn::Mul(form(5), hn::Mul(dy, dz))));
                weight = hn::Sqrt(hn::Max(hn::Add(squares, hn::Add(mixed, mixed)), hn::Zero(d)));
                weight = hn::IfThenElseZero(seen, Weight<Kind>(d, weight, block, k));
                add(0, weight);
                weight = hn::Mul(weight, hn::Set(d, 1.f / 254));
                const Vec near_weight = hn::Mul(weight, near_share), far_weight = hn::Mul(weight, far_share);
                add(1, hn::Add(near_weight, far_weight));
                add(3, far_weight);
                for (int c = 0; c < 3; ++c)
                    add(5 + c, hn::MulAdd(near_weight, hn::Set(d, near_light[c]),
                                          hn::Mul(far_weight, hn::Set(d, far_light[c]))));
            } else {
                const Vec facing = hn::MulAdd(
                    hn::Load(d, block.normal[0] + k), dx,
                    hn::MulAdd(hn::Load(d, block.normal[1] + k), dy, hn::Mul(hn::Load(d, block.normal[2] + k), dz)));
                const auto front_near = hn::Lt(facing, hn::Zero(d));
                weight = hn::IfThenElseZero(seen, Weight<Kind>(d, hn::Abs(facing), block, k));
                add(0, weight);
                weight = hn::Mul(weight, hn::Set(d, 1.f / 254));
                const Vec near_weight = hn::Mul(weight, near_share), far_weight = hn::Mul(weight, far_share);
                add(1, hn::IfThenElse(front_near, near_weight, far_weight));
                add(2, hn::IfThenElse(front_near, far_weight, near_weight));
                add(3, hn::IfThenZeroElse(front_near, far_weight));
                add(4, hn::IfThenElseZero(front_near, far_weight));
                for (int c = 0; c < 3; ++c) {
                    const Vec from_near = hn::Mul(near_weight, hn::Set(d, near_light[c])),
                              from_far = hn::Mul(far_weight, hn::Set(d, far_light[c]));
                    add(5 + c, hn::IfThenElse(front_near, from_near, from_far));
                    add(8 + c, hn::IfThenElse(front_near, from_far, from_near));
                }
            }
        }
    }
}

void GatherFacets(const Facets& facets, std::span<const glm::vec3> directions, const OpenFractions& open,
                  const EndRadiance& radiance, std::size_t first, std::size_t last, std::size_t facet, std::size_t end,
                  bool bark, std::span<EndSums> sums) {
    FacetArrays block;
    const auto gather = [&]<FacetKind Kind>(std::size_t count) {
        GatherBlock<Kind>(block, directions, open, radiance, first, last, facet, count);
    };
    for (; facet < end; facet += FacetArrays::kBlock) {
        const std::size_t count = std::min(FacetArrays::kBlock, end - facet);
        bool any_masked = false;
        for (std::size_t k = 0; k < FacetArrays::kBlock; ++k) {
            const Facet& source = facets.facets[facet + std::min(k, count - 1)];
            for (int j = 0; j < 3; ++j)
                block.normal[j][k] = source.normal[j];
            for (int j = 0; j < 6; ++j)
                block.form[j][k] = source.form[j];
            block.pixels[k] = std::clamp(source.area * open.pixels_per_area, 1e-6f, 1e6f);
            for (auto& quantity : block.sums)
                quantity[k] = 0;
            block.masked[k] = float(source.masked);
            any_masked = any_masked || source.masked;
        }
        if (bark)
            gather.template operator()<FacetKind::bark>(count);
        else if (any_masked)
            gather.template operator()<FacetKind::any_leaf>(count);
        else
            gather.template operator()<FacetKind::solid_leaf>(count);
        for (std::size_t k = 0; k < count; ++k) {
            EndSums& sum = sums[facet + k];
            sum.weight += block.sums[0][k];
            sum.front_open += block.sums[1][k];
            sum.back_open += block.sums[2][k];
            sum.front_down += block.sums[3][k];
            sum.back_down += block.sums[4][k];
            for (int c = 0; c < 3; ++c) {
                sum.front[c] += block.sums[5 + c][k];
                sum.back[c] += block.sums[8 + c][k];
            }
        }
    }
}

} // namespace kokage::bundles::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kokage::bundles {

HWY_EXPORT(GatherFacets);

void gather_ends(const Facets& facets, std::span<const glm::vec3> directions, const OpenFractions& open,
                 const EndRadiance& radiance, std::size_t first, std::size_t last, std::span<EndSums> sums) {
    auto range = [&](std::size_t begin, std::size_t end, bool bark) {
        parallel_blocks(end - begin, std::size_t(1) << 14, [&](std::size_t from, std::size_t to) {
            HWY_DYNAMIC_DISPATCH(GatherFacets)
            (facets, directions, open, radiance, first, last, begin + from, begin + to, bark, sums);
        });
    };
    range(0, facets.leaf_facet_count, false);
    range(facets.leaf_facet_count, facets.facets.size(), true);
}

} // namespace kokage::bundles
#endif
