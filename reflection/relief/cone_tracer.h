#pragma once
// Cone step mapping, a peer: cones over the surface that hold none of it say how far a ray may go at once.
#include "reflection/relief/relief_tracer.h"

namespace kokage {

/// The cones of cone_map.h, so that no ray passes a hit; where a ray dips below the top of the cell that it stands
/// over, the exact root in that cell decides, so that hits are exact within single precision. At grazing angles cones
/// are narrow where rays are flat: steps shrink to a cell each. A read is one cone (top and ratio), or one 2 x 2 cell.
/// Vector code of single precision; rays with numbers beyond it are traced cell by cell. `field` is kept by reference.
/// Throws InputError for what linear_tracer.h's does.
std::unique_ptr<ReliefTracer> make_cone_tracer(const HeightField& field);

} // namespace kokage
