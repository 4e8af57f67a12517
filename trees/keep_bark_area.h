#pragma once
// Coarse bark made as large as the bark that it stands for. Private to levels of detail.
#include "trees/tree.h"

#include <cstdint>
#include <vector>

namespace kokage {

/// Bark some of which may grow.
struct GrowingBark {
    TreePart part;
    std::vector<std::uint8_t> may_grow; ///< per triangle: 1 if it may
};

/// Moves the vertices of growing triangles outwards, all by one length, along their normals (means over vertices at the
/// same place, so that seams stay shut), until the parts together have `area` (m^2). Surface is what is seen of wood:
/// the mean shadow of a convex body is a quarter of it (Cauchy). Some elements at random, enlarged to the area of all,
/// are stochastic simplification (Cook, Halstead, Planck and Ryu 2007, "Stochastic Simplification of Aggregate
/// Detail"); they scale by a factor, here radii grow by a sum, so that twigs grow by more than boughs.
/// Bark that has the area already stays as it is, as do vertices of triangles that may not grow. Nothing is moved
/// further than `furthest` (m), so that the area may fall short. Gives back the length (m).
double keep_bark_area(std::vector<GrowingBark>& parts, double area, double furthest);

} // namespace kokage
