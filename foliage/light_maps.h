#pragma once
// Method `light-maps`: [F] made physical.
#include "foliage/method.h"

namespace kokage {

/// Lights are split off; first light (lights, sky) is found per patch; light-environment maps (options.maps, 100 by
/// default) carry every bounce, read from the nearest maps with convex weights of distance and visibility, by
/// options.gather: `rule` (eqs 2-3 of [F]) or `cosine` (the map convolved with the two-sided cosine). Bounces:
/// options.max_bounces, or until the residual is below a tenth of options.error. Contracts by max(rho + tau) or better
/// (LightMapField). Throws InputError for options out of range.
std::unique_ptr<Transport> make_light_maps_transport(const PatchScene& scene, const Tree& tree,
                                                     const ShadingOptions& options, Progress& progress);

} // namespace kokage
