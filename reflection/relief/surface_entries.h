#pragma once
// Camera rays on relief: from entry to entry, for renderers.
#include "reflection/relief/surface_relief.h"

#include <functional>

namespace kokage {

struct SurfaceEntry {
    std::uint32_t triangle = 0;
    float distance = 0;
};

/// Finds where ray `ray` next meets the mesh's outside beyond `after` and before `before`, both distances from its
/// origin; false: nowhere. (Embree's closest hit, passing over triangles seen from inside.)
using NextSurfaceEntry = std::function<bool(std::size_t ray, float after, float before, SurfaceEntry& entry)>;

/// The nearest hits of all: rays that come out of the shell again go on to their next entry, and where tubes of one
/// mesh pass through one another (a branch's foot in its trunk) all entries before the nearest hit are followed.
/// `rays`: triangle and distance mean nothing; strength is asked for where a ray enters, by `strength(ray, distance)`.
void trace_from_outside(const SurfaceRelief& surface, std::span<const SurfaceRay> rays, const NextSurfaceEntry& next,
                        const std::function<float(std::size_t ray, float distance)>& strength,
                        std::span<SurfaceHit> hits);

} // namespace kokage
