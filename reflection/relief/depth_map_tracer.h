#pragma once
// Ray casting with depth maps: [D] to the letter, and a variant that never passes the hit.
#include "reflection/relief/depth_maps.h"

#include <memory>

namespace kokage {

struct DepthMapSearch {
    int steps = 64;     ///< of equal depth from the plane to depth 1 ([D] 1, as linear_tracer.h's); 1 to 4096
    int bisections = 6; ///< 0 to 24
    /// Shadows: how much nearer to the light, in depth, the light's hit has to be than the view ray's to be another.
    float same_hit = 1.f / 256;
};

/// [D] 3: the map of the sampling direction nearest to the ray (the nearest azimuth, and of the two zenith angles
/// beside the ray's the one nearer to the zenith); its depth at O; eq 1; then equal steps forward from P if it lies
/// above the relief, or backward out of it if inside; bisection. Shadows ([D] 5): the same search from the light.
/// First hits of rays that go upwards, and rays that pass the plane beyond the border of a clamped tile, have no map:
/// equal steps from where they start. Vector code as linear_tracer's, with the same limits. Throws InputError where the
/// maps are no first_hits. `field` is kept by reference.
std::unique_ptr<ReliefTracer> make_depth_map_tracer(const HeightField& field, DepthMaps maps,
                                                    const DepthMapSearch& search = {});

/// Lower bounds, from where `exact` (a tracer of the same field) goes on: its hits, and its shadows. Throws InputError
/// where the maps are no lower_bounds.
std::unique_ptr<ReliefTracer> make_conservative_tracer(const HeightField& field, DepthMaps maps,
                                                       std::unique_ptr<ReliefTracer> exact);

} // namespace kokage
