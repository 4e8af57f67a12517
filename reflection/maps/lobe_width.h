#pragma once
// How wide a lobe is, as shells are spaced and sized by it.
#include "reflection/maps/lobe.h"

namespace kokage {

/// A lobe's width in radians: Phong 1/sqrt(Λ+1), its standard deviation along one axis (of a sharp one; finite at
/// Λ = 0); GGX α = roughness², the half width of its peak.
double lobe_width(const Lobe& lobe);
Lobe lobe_of_width(LobeKind kind, double width);
/// Width squared: what a blur's change of a smooth image is proportional to.
double lobe_spread(const Lobe& lobe);
Lobe lobe_of_spread(LobeKind kind, double spread);

} // namespace kokage
