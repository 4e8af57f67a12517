#pragma once
// Cone step mapping, a peer: cones over the surface that hold none of it say how far a ray may go at once.
#include "reflection/relief/relief_tracer.h"

#include <filesystem>

namespace kokage {

class ConeTracer : public ReliefTracer {
  public:
    /// The cones; loading them is faster than making them. Throws InputError.
    virtual void store(const std::filesystem::path& path) const = 0;
};

/// The cones of cone_map.h, so that no ray passes a hit; where a ray dips below the top of the cell that it stands
/// over, the exact root in that cell decides, so that hits are exact within single precision. At grazing angles cones
/// are narrow where rays are flat: steps shrink to a cell each. Rays that start within rounding of the surface (on a
/// texel of a needle, a million tiles away) may hit it at t = 0, or a texel late: exact_tracer.h looks again at those,
/// this peer does not. A read is one cone (top and ratio), or one 2 x 2 cell.
/// Vector code of single precision; rays with numbers beyond it are traced cell by cell. `field` is kept by reference.
/// Throws InputError for what linear_tracer.h's does.
std::unique_ptr<ConeTracer> make_cone_tracer(const HeightField& field);
/// With the cones that store() wrote for this very field. Throws InputError for any other file.
std::unique_ptr<ConeTracer> load_cone_tracer(const HeightField& field, const std::filesystem::path& path);

} // namespace kokage
