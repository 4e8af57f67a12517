#include "common/services/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/directions/ring_product.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "common/directions/ring_product.h"

HWY_BEFORE_NAMESPACE();
namespace kokage::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<float, 16>;
using Vec = hn::Vec<Tag>;
constexpr std::size_t kColumns = 6;

/// kVectors vectors of the result at once: as many sums as registers hold.
template <std::size_t kVectors>
HWY_INLINE void analysis(const float* HWY_RESTRICT table, std::size_t rows, std::size_t count,
                         const float* HWY_RESTRICT values, float* HWY_RESTRICT result) {
    const Tag d;
    const std::size_t lanes = hn::Lanes(d);
    Vec sums[kVectors][kColumns];
    for (std::size_t v = 0; v < kVectors; ++v)
        for (std::size_t c = 0; c < kColumns; ++c)
            sums[v][c] = hn::Zero(d);
    for (std::size_t k = 0; k < rows; ++k, table += count, values += kColumns) {
        Vec factors[kVectors];
        for (std::size_t v = 0; v < kVectors; ++v)
            factors[v] = hn::LoadU(d, table + v * lanes);
        for (std::size_t c = 0; c < kColumns; ++c) {
            const Vec value = hn::Set(d, values[c]);
            for (std::size_t v = 0; v < kVectors; ++v)
                sums[v][c] = hn::MulAdd(factors[v], value, sums[v][c]);
        }
    }
    for (std::size_t v = 0; v < kVectors; ++v)
        for (std::size_t c = 0; c < kColumns; ++c)
            hn::StoreU(sums[v][c], d, result + c * count + v * lanes);
}

template <std::size_t kFunctions>
HWY_INLINE void synthesis(const float* HWY_RESTRICT table, std::size_t rows, const float* HWY_RESTRICT coefficients,
                          std::size_t column, const float* const* zonals, float* HWY_RESTRICT result) {
    const Tag d;
    for (std::size_t lane = 0; lane < BatchFft::kLanes; lane += hn::Lanes(d)) {
        Vec sums[kFunctions][kColumns];
        for (std::size_t f = 0; f < kFunctions; ++f)
            for (std::size_t c = 0; c < kColumns; ++c)
                sums[f][c] = hn::Zero(d);
        for (std::size_t k = 0; k < rows; ++k) {
            const Vec factor = hn::LoadU(d, table + k * BatchFft::kLanes + lane);
            Vec filtered[kFunctions];
            for (std::size_t f = 0; f < kFunctions; ++f)
                filtered[f] = hn::Mul(factor, hn::Set(d, zonals[f][k]));
            for (std::size_t c = 0; c < kColumns; ++c) {
                const Vec value = hn::Set(d, coefficients[c * column + k]);
                for (std::size_t f = 0; f < kFunctions; ++f)
                    sums[f][c] = hn::MulAdd(filtered[f], value, sums[f][c]);
            }
        }
        for (std::size_t f = 0; f < kFunctions; ++f)
            for (std::size_t c = 0; c < kColumns; ++c)
                hn::StoreU(sums[f][c], d, result + (f * kColumns + c) * BatchFft::kLanes + lane);
    }
}

} // namespace

void AnalysisProduct(const float* table, std::size_t rows, std::size_t count, const float* values, float* result) {
    const std::size_t lanes = hn::Lanes(Tag());
    std::size_t i = 0;
#if HWY_TARGET <= HWY_AVX3 // 32 registers
    for (; i + 4 * lanes <= count; i += 4 * lanes)
        analysis<4>(table + i, rows, count, values, result + i);
#endif
    for (; i + 2 * lanes <= count; i += 2 * lanes)
        analysis<2>(table + i, rows, count, values, result + i);
    for (; i < count; i += lanes)
        analysis<1>(table + i, rows, count, values, result + i);
}

void SynthesisProduct(const float* table, std::size_t rows, const float* coefficients, std::size_t column,
                      const float* const* zonals, std::size_t functions, float* result) {
#if HWY_TARGET <= HWY_AVX3 // 32 registers
    if (functions == 3)
        return synthesis<3>(table, rows, coefficients, column, zonals, result);
    if (functions == 2)
        return synthesis<2>(table, rows, coefficients, column, zonals, result);
#endif
    for (std::size_t f = 0; f < functions; ++f)
        synthesis<1>(table, rows, coefficients, column, zonals + f, result + f * kColumns * BatchFft::kLanes);
}

void InterleaveRings(const float* red, const float* green, const float* blue, std::size_t columns, std::size_t rings,
                     float* const* rows) {
    const Tag d;
    const std::size_t lanes = hn::Lanes(d);
    constexpr std::size_t kLanes = BatchFft::kLanes, kAtOnce = 4; // columns: a line of the cache in every row
    HWY_ALIGN float pixels[kAtOnce][4 * kLanes];
    const hn::FixedTag<float, 4> pixel;
    for (std::size_t column = 0; column < columns; column += kAtOnce) {
        const std::size_t here = HWY_MIN(kAtOnce, columns - column);
        for (std::size_t i = 0; i < here; ++i)
            for (std::size_t lane = 0; lane < kLanes; lane += lanes) {
                const std::size_t at = (column + i) * BatchFft::kElement + lane;
                hn::StoreInterleaved4(hn::LoadU(d, red + at), hn::LoadU(d, green + at), hn::LoadU(d, blue + at),
                                      hn::Zero(d), d, pixels[i] + 4 * lane);
            }
        for (std::size_t ring = 0; ring < rings; ++ring)
            for (std::size_t i = 0; i < here; ++i)
                hn::StoreU(hn::Load(pixel, pixels[i] + 4 * ring), pixel, rows[ring] + 4 * (column + i));
    }
}

} // namespace kokage::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kokage {

HWY_EXPORT(AnalysisProduct);
HWY_EXPORT(SynthesisProduct);
HWY_EXPORT(InterleaveRings);

void ring_analysis_product(const float* table, std::size_t rows, std::size_t count, const float* values,
                           float* result) {
    HWY_DYNAMIC_DISPATCH(AnalysisProduct)(table, rows, count, values, result);
}

void ring_synthesis_product(const float* table, std::size_t rows, const float* coefficients, std::size_t column,
                            const float* const* zonals, std::size_t functions, float* result) {
    HWY_DYNAMIC_DISPATCH(SynthesisProduct)(table, rows, coefficients, column, zonals, functions, result);
}

void interleave_rings(const float* red, const float* green, const float* blue, std::size_t columns, std::size_t rings,
                      float* const* rows) {
    HWY_DYNAMIC_DISPATCH(InterleaveRings)(red, green, blue, columns, rings, rows);
}

} // namespace kokage
#endif
