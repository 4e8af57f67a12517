// Vector code by Google Highway: compiled once for every instruction set, chosen at run time.
// Arrays of vectors rule out the sizeless vectors of SVE and RVV; Arm has NEON for it.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
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
HWY_INLINE void product(const float* HWY_RESTRICT table, std::size_t table_stride, std::size_t rows,
                        const RingColumns& columns, float* HWY_RESTRICT result, std::size_t result_stride) {
    const Tag d;
    const std::size_t lanes = hn::Lanes(d);
    Vec sums[kVectors][kColumns];
    for (std::size_t v = 0; v < kVectors; ++v)
        for (std::size_t c = 0; c < kColumns; ++c)
            sums[v][c] = hn::Zero(d);
    const float* HWY_RESTRICT values = columns.values;
    for (std::size_t k = 0; k < rows; ++k, table += table_stride, values += columns.row) {
        Vec factors[kVectors];
        for (std::size_t v = 0; v < kVectors; ++v)
            factors[v] = hn::LoadU(d, table + v * lanes);
        for (std::size_t c = 0; c < kColumns; ++c) {
            const Vec value = hn::Set(d, values[c * columns.column]);
            for (std::size_t v = 0; v < kVectors; ++v)
                sums[v][c] = hn::MulAdd(factors[v], value, sums[v][c]);
        }
    }
    for (std::size_t v = 0; v < kVectors; ++v)
        for (std::size_t c = 0; c < kColumns; ++c)
            hn::StoreU(sums[v][c], d, result + c * result_stride + v * lanes);
}

} // namespace

void RingProduct(const float* table, std::size_t table_stride, std::size_t rows, std::size_t count,
                 const RingColumns& columns, float* result, std::size_t result_stride) {
    const std::size_t lanes = hn::Lanes(Tag());
    std::size_t i = 0;
#if HWY_TARGET <= HWY_AVX3 // 32 registers
    for (; i + 4 * lanes <= count; i += 4 * lanes)
        product<4>(table + i, table_stride, rows, columns, result + i, result_stride);
#endif
    for (; i + 2 * lanes <= count; i += 2 * lanes)
        product<2>(table + i, table_stride, rows, columns, result + i, result_stride);
    for (; i < count; i += lanes)
        product<1>(table + i, table_stride, rows, columns, result + i, result_stride);
}

} // namespace kokage::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kokage {

HWY_EXPORT(RingProduct);

void ring_product(const float* table, std::size_t table_stride, std::size_t rows, std::size_t count,
                  const RingColumns& columns, float* result, std::size_t result_stride) {
    HWY_DYNAMIC_DISPATCH(RingProduct)(table, table_stride, rows, count, columns, result, result_stride);
}

} // namespace kokage
#endif
