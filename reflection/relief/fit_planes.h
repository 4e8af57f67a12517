#pragma once
// The planes of a hierarchy, fitted to the surface under them. Private to relief.
#include "reflection/relief/bound_planes.h"

namespace kokage {

/// Fills bounds.planes from bounds.depths; levels are laid out already. In vector code; the same planes, up to
/// rounding, on every machine.
void fit_planes(BoundPlanes& bounds);

} // namespace kokage
