#pragma once
// From samples of a function to the texels whose interpolation is closest to it.
#include "common/types.h"

#include <span>
#include <vector>

namespace kokage {

/// A symmetric filter along both axes: weight of the texel itself, of its neighbours, of theirs, ...
using SymmetricTaps = std::span<const double>;

/// For bilinear interpolation; reads 1 texel around.
SymmetricTaps bilinear_prefilter();
/// For the uniform cubic B-spline; reads 4 texels around.
SymmetricTaps cubic_prefilter();

/// Filters a square of `width`² samples along rows, then columns, and leaves out `taps.size() - 1` texels on every
/// side, and `skipped` more. Sums in double.
std::vector<glm::vec3> prefiltered(std::span<const glm::vec3> samples, int width, SymmetricTaps taps, int skipped);

} // namespace kokage
