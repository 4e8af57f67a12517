#pragma once
// Discs of light seen through a lobe.
#include "common/environment/environment.h"
#include "reflection/maps/lobe.h"

namespace kokage {

/// Integral of the lobe over the cone within `half_angle` of an axis that is `angle` away from the lobe's own
/// (radians, 0 to pi): how much of the lobe's mass a disc of light covers. Relative error 1e-10 of the larger of
/// the result and its share of the peak; by quadrature over angles from the lobe's axis, where the arc that lies in the
/// cone is known.
double lobe_over_cone(const Lobe& lobe, double angle, double half_angle);

/// A quadrature over that cone in circles around the lobe's axis.
struct LobeArc {
    double angle;    ///< of the circle from the lobe's axis
    double half_arc; ///< radians of it, on either side of the meridian towards the cone's axis, that lie in the cone
    double mass;     ///< lobe's value x sin(angle) d(angle): the circle's share of the lobe's mass, a radian
};
/// Circles that the cone doesn't meet are left out. `nodes` on each piece between consecutive bends: 32 give 1e-10, 10
/// give 1e-5.
std::vector<LobeArc> arcs_in_cone(const Lobe& lobe, double angle, double half_angle, int nodes = 32);

/// Radiance of a light at infinity as the lobe around a unit direction shows it. A light without extent counts by the
/// lobe's value towards it.
glm::dvec3 light_through_lobe(const DistantLight& light, const Lobe& lobe, const glm::dvec3& direction);

} // namespace kokage
