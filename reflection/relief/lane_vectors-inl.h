// The vectors whose lanes are rays on relief, and what all code for them needs. Per-target code of Google Highway:
// included once for every instruction set, so the guard toggles.
#include <cstddef>
#include <cstdint>
#include <cstring>

#include <hwy/highway.h>

#if defined(KOKAGE_LANE_VECTORS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KOKAGE_LANE_VECTORS_INL_H
#undef KOKAGE_LANE_VECTORS_INL_H
#else
#define KOKAGE_LANE_VECTORS_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace kokage::relief_lanes::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, 16>;
using IntTag = hn::RebindToSigned<Tag>;
using Vec = hn::Vec<Tag>;
using Int = hn::Vec<IntTag>;
using Mask = hn::Mask<Tag>;
constexpr std::size_t kLanes = hn::MaxLanes(Tag());

HWY_INLINE Vec Constant(float value) {
    return hn::Set(Tag(), value);
}
HWY_INLINE Int Whole(int value) {
    return hn::Set(IntTag(), value);
}
HWY_INLINE std::uint32_t Bits(Mask mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(Tag(), mask, bytes);
    std::uint32_t bits;
    std::memcpy(&bits, bytes, sizeof bits);
    return bits;
}
/// Calls body(lane) for the lanes of a mask, in order.
template <class Body>
HWY_INLINE void ForEach(Mask mask, Body&& body) {
    for (std::uint32_t bits = Bits(mask); bits; bits &= bits - 1)
        body(std::size_t(hwy::Num0BitsBelowLS1Bit_Nonzero32(bits)));
}

} // namespace kokage::relief_lanes::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
