#pragma once
// From surroundings to filtered light: one interface, three methods.
#include "common/environment/environment.h"
#include "common/services/progress.h"
#include "common/services/work_report.h"
#include "reflection/maps/texel_layout.h"

#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace kokage {

enum class BakeMethod {
    spectral,    ///< spherical harmonics x the lobe's zonal coefficients, split-off lights as analytic lobes (default)
    table,       ///< [R] section 6: geodesic domes, pyramid, a table of weights above a threshold
    brute_force, ///< [R] eqs 8 and 9 in double precision, every pixel with its true solid angle: the truth
};
std::string_view bake_method_name(BakeMethod method);
/// "spectral", "table", "brute-force"; throws InputError that lists them.
BakeMethod bake_method_from_name(std::string_view name);

/// Made for one layout and one size of image: what does not depend on the light is prepared once (`setup`), and kept
/// from frame to frame.
class Baker {
  public:
    virtual ~Baker() = default;
    /// Filtered radiance of every texel, in the layout's order; `filtered` has the layout's size. `surroundings` are
    /// NOT split (EnvironmentLoading::split = false): `remainder` is the whole image, finite and not negative, of the
    /// size that the baker was made for; `distant_lights` are those that the user added (discs), filtered too; point
    /// lights are no part of surroundings at infinity and are ignored. The same bits with any number of threads.
    /// Adds stages, counts, skips to the report. Throws Stopped.
    virtual void bake(const Environment& surroundings, std::span<glm::vec3> filtered, WorkReport& report,
                      Progress& progress = silent_progress()) = 0;
};

} // namespace kokage
