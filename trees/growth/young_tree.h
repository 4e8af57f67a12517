#pragma once
// Trees of few leaves are young ones: slender, with a leader, and leafy far down, whatever the species becomes later.
#include "trees/growth/parameters.h"

namespace kokage {

/// How young a tree of so few leaves is: 0 from `young_below` leaves on (grown as its parameters say), 1 at fifty and
/// fewer (a seedling), in between by the logarithm of the number.
double youth(const GrowthParameters& parameters);

/// The parameters of a tree of this age: those of the grown tree where youth() is 0, drawn to a young tree's the more
/// the younger it is. A stem that reaches the top and bears limbs from low down (all ten species begin as one
/// upright axis; those whose trunk dissolves in limbs lose it later), a crown that is taller than wide and loosely
/// filled, thin shoots that bear their leaves without bending.
GrowthParameters at_its_age(const GrowthParameters& parameters);

} // namespace kokage
