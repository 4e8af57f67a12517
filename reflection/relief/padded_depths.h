#pragma once
// Depths as vector code reads them. Private to relief.
#include "reflection/relief/height_field.h"

namespace kokage {

/// A height field with one more column and row, of what comes after the last ones, so that the four corners of every
/// cell lie beside one another.
struct PaddedDepths {
    int width = 0, height = 0; ///< of the field
    HeightWrap wrap = HeightWrap::repeat;
    std::vector<float> depths; ///< (width + 1) x (height + 1)

    /// Throws InputError for a field that is empty, larger than 32767 texels on a side, or has a depth outside [0, 1].
    explicit PaddedDepths(const HeightField& field);
    int stride() const { return width + 1; }
    std::size_t bytes() const { return depths.size() * sizeof(float); }
};

} // namespace kokage
