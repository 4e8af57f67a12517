#pragma once
// Maps with holes. Private to relief.
#include "reflection/relief/height_field.h"

#include <span>

namespace kokage {

/// Fills values that are NaN or infinite, layer by layer from the finite ones around: each takes the mean of those of
/// its 8 neighbours that are known before its layer; neighbours are found across the edges of a repeated tile. Says how
/// many it filled; none is finite: fills nothing and says width x height.
std::size_t repair_texels(std::span<float> values, int width, int height, HeightWrap wrap);

} // namespace kokage
