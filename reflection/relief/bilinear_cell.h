#pragma once
// One bilinear cell of a height field, in double precision. Private to relief.
#include "reflection/relief/height_field.h"

#include <cmath>

namespace kokage {

/// Depth over a cell: d00 + a du + b dv + a b duv, (a, b) in [0, 1]² from the centre of its first texel.
struct BilinearCell {
    double d00 = 0, du = 0, dv = 0, duv = 0;

    double depth(double a, double b) const { return d00 + a * du + b * dv + a * b * duv; }
};

/// The texel that stands at `i` of `count`: wrapped around, or the border's.
inline int texel_index(long long i, int count, HeightWrap wrap) {
    if (wrap == HeightWrap::clamp)
        return i < 0 ? 0 : i >= count ? count - 1 : int(i);
    const long long rest = i % count;
    return int(rest < 0 ? rest + count : rest);
}

inline BilinearCell bilinear_cell(const HeightField& field, long long i, long long j) {
    const int x0 = texel_index(i, field.width, field.wrap), x1 = texel_index(i + 1, field.width, field.wrap);
    const int y0 = texel_index(j, field.height, field.wrap), y1 = texel_index(j + 1, field.height, field.wrap);
    const double d00 = field.depth(x0, y0), d10 = field.depth(x1, y0), d01 = field.depth(x0, y1),
                 d11 = field.depth(x1, y1);
    return {d00, d10 - d00, d01 - d00, d11 - d10 - d01 + d00};
}

} // namespace kokage
