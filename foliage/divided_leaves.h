#pragma once
// Leaves cut into parts, so that light varies over a side; seen from outside as the scene with whole leaves.
#include "foliage/method.h"

#include <functional>

namespace kokage {

/// Makes a transport for the divided scene (which outlives it).
using TransportMaker = std::function<std::unique_ptr<Transport>(const PatchScene& divided)>;

/// True if `scene` is make_patches() of this tree with whole leaves, so that it can be divided.
bool can_divide_leaves(const PatchScene& scene, const Tree& tree);

/// A transport over leaves in about 4^subdivisions parts; its solutions are means over the parts of each leaf, by area.
std::unique_ptr<Transport> make_divided_transport(const PatchScene& scene, const Tree& tree, int subdivisions,
                                                  const TransportMaker& make);

} // namespace kokage
