#include "common/services/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reflection/maps/spectral_read.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "reflection/maps/spectral_read.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#ifndef KOKAGE_SPECTRAL_READ_ONCE
#define KOKAGE_SPECTRAL_READ_ONCE
namespace kokage {
/// A grid as the inner loop wants it.
struct GridView {
    const float* origin;   ///< cell (0, 0) of the 4 x 4 around ring -1, column 0
    std::ptrdiff_t stride; ///< floats a row
};
struct GridViews {
    std::vector<GridView> grids;
    std::vector<float> columns, rings; ///< padded to whole vectors beyond the last grid
};
} // namespace kokage
#endif

HWY_BEFORE_NAMESPACE();
namespace kokage::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
/// 16 floats: four cells of four channels, or as many of them as a vector holds.
using Tag = hn::CappedTag<float, 16>;
using Vec = hn::Vec<Tag>;
using Tag4 = hn::FixedTag<float, 4>;
using Vec4 = hn::Vec<Tag4>;
constexpr std::size_t kLanes = hn::MaxLanes(Tag()), kParts = 16 / kLanes;

/// Weights of the four cells in a row, each for all of the cell's channels.
struct Across {
    Vec factors[4][kParts];
    HWY_INLINE Across() {
        HWY_ALIGN float lanes[16];
        for (std::size_t power = 0; power < 4; ++power) {
            for (std::size_t lane = 0; lane < 16; ++lane)
                lanes[lane] = kRingSpline[power][lane / 4];
            for (std::size_t part = 0; part < kParts; ++part)
                factors[power][part] = hn::Load(Tag(), lanes + part * kLanes);
        }
    }
    HWY_INLINE Vec weights(std::size_t part, Vec t) const {
        return hn::MulAdd(hn::MulAdd(hn::MulAdd(factors[0][part], t, factors[1][part]), t, factors[2][part]), t,
                          factors[3][part]);
    }
};

/// Weights of the four rows, one after another in every group of four lanes.
struct Down {
    Vec factors[4];
    HWY_INLINE Down() {
        for (std::size_t power = 0; power < 4; ++power)
            factors[power] = hn::LoadDup128(Tag(), kRingSpline[power]);
    }
    HWY_INLINE Vec weights(Vec s) const {
        return hn::MulAdd(hn::MulAdd(hn::MulAdd(factors[0], s, factors[1]), s, factors[2]), s, factors[3]);
    }
};

/// The sum over cells of four channels.
template <class D, class V>
HWY_INLINE Vec4 sum_of_cells(D, V values) {
    if constexpr (hn::MaxLanes(D()) == 4) {
        return values;
    } else {
        const hn::Half<D> half;
        return sum_of_cells(half, hn::Add(hn::LowerHalf(half, values), hn::UpperHalf(half, values)));
    }
}

template <std::size_t kGrids>
HWY_INLINE float read(std::span<const TexelPlace> places, const GridViews& views, float scale, glm::vec3* filtered) {
    const Tag d;
    const Tag4 d4;
    const hn::RebindToSigned<Tag4> d4i;
    const Across across;
    const Down down;
    const Vec4 zero = hn::Zero(d4), half = hn::Set(d4, 0.5f), scales = hn::Set(d4, scale);
    Vec4 least = zero;
    for (const TexelPlace& place : places) {
        // Cells and fractions in all grids at once. Ring -1 is counted as 0.
        const Vec4 x = hn::Mul(hn::Set(d4, place.turn), hn::LoadU(d4, views.columns.data() + place.first));
        const Vec4 y = hn::MulAdd(hn::Set(d4, place.polar), hn::LoadU(d4, views.rings.data() + place.first), half);
        const auto column = hn::ConvertTo(d4i, x), ring = hn::ConvertTo(d4i, y);
        HWY_ALIGN float t[4], s[4];
        HWY_ALIGN std::int32_t columns[4], rings[4];
        hn::Store(hn::Sub(x, hn::ConvertTo(d4, column)), d4, t);
        hn::Store(hn::Sub(y, hn::ConvertTo(d4, ring)), d4, s);
        hn::Store(column, d4i, columns);
        hn::Store(ring, d4i, rings);
        Vec sums[kParts];
        for (std::size_t part = 0; part < kParts; ++part)
            sums[part] = hn::Zero(d);
        for (std::size_t k = 0; k < kGrids; ++k) {
            const GridView& grid = views.grids[place.first + k];
            const float* cells = grid.origin + rings[k] * grid.stride + columns[k] * 4;
            const Vec rows = down.weights(hn::Set(d, s[k])), shift = hn::Set(d, t[k]),
                      weight = hn::Set(d, place.weights[k]);
            const Vec row0 = hn::Broadcast<0>(rows), row1 = hn::Broadcast<1>(rows), row2 = hn::Broadcast<2>(rows),
                      row3 = hn::Broadcast<3>(rows);
            for (std::size_t part = 0; part < kParts; ++part) {
                const float* from = cells + part * kLanes;
                Vec sum = hn::Mul(row0, hn::LoadU(d, from));
                sum = hn::MulAdd(row1, hn::LoadU(d, from + grid.stride), sum);
                sum = hn::MulAdd(row2, hn::LoadU(d, from + 2 * grid.stride), sum);
                sum = hn::MulAdd(row3, hn::LoadU(d, from + 3 * grid.stride), sum);
                sums[part] = hn::MulAdd(hn::Mul(weight, across.weights(part, shift)), sum, sums[part]);
            }
        }
        for (std::size_t part = 1; part < kParts; ++part)
            sums[0] = hn::Add(sums[0], sums[part]);
        const Vec4 value = sum_of_cells(d, sums[0]);
        least = hn::Min(least, value);
        HWY_ALIGN float out[4];
        hn::Store(hn::Mul(scales, hn::Max(value, zero)), d4, out);
        std::memcpy(&filtered[place.texel], out, sizeof(glm::vec3));
    }
    return hn::GetLane(hn::MinOfLanes(d4, least));
}

} // namespace

float ReadTexels(std::span<const TexelPlace> places, const GridViews& views, std::size_t grids_a_texel, float scale,
                 glm::vec3* filtered) {
    return grids_a_texel == 1 ? read<1>(places, views, scale, filtered) : read<4>(places, views, scale, filtered);
}

} // namespace kokage::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kokage {

HWY_EXPORT(ReadTexels);

TexelPlace texel_place(const glm::vec3& direction, const ShellMix& mix, std::uint32_t texel) {
    const glm::dvec3 d(direction);
    double turn = std::atan2(d.z, d.x) / (2 * kPiDouble);
    turn -= std::floor(turn);
    const double polar = std::atan2(std::hypot(d.x, d.z), d.y) / kPiDouble;
    return {float(turn) < 1 ? float(turn) : 0.f, float(std::min(polar, 1.0)), mix.weights, texel,
            std::uint32_t(mix.first)};
}

float read_texels(std::span<const TexelPlace> places, std::span<const RingGrid> grids, std::size_t grids_a_texel,
                  float scale, std::span<glm::vec3> filtered) {
    GridViews views;
    for (const RingGrid& grid : grids) {
        views.grids.push_back({&grid.at(-2, -1).x, std::ptrdiff_t(grid.stride()) * 4});
        views.columns.push_back(float(grid.columns));
        views.rings.push_back(float(grid.rings));
    }
    views.columns.resize(grids.size() + 4);
    views.rings.resize(grids.size() + 4);
    return HWY_DYNAMIC_DISPATCH(ReadTexels)(places, views, grids_a_texel, scale, filtered.data());
}

} // namespace kokage
#endif
