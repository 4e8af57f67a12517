#pragma once
// What a lobe shows of surroundings at infinity, for surfaces in a scene. Private to reflection.
#include "common/environment/environment.h"
#include "common/services/progress.h"
#include "common/services/work_report.h"
#include "reflection/maps/horizon.h"
#include "reflection/maps/shell_map.h"

namespace kokage {

/// Lobes narrower than a light find it for themselves, wider ones are found from the light: then neither makes noise.
bool is_wide_for(const DistantLight& light, float roughness);
/// Radiance of the lights that are wide for lobes of this roughness.
glm::vec3 wide_lights_in(const Environment& environment, const glm::vec3& direction, float roughness);

/// The environment's remainder through GGX lobes, from a multi-scale map with the horizon's correction. Thread-safe.
class GlossyRemainder {
  public:
    /// For surfaces of a range of roughness, 0 < least <= most <= 1. Of lobes that are narrower than half a pixel of
    /// the environment it bakes the narrowest that isn't. Adds its work to the report.
    GlossyRemainder(const Environment& environment, float least_roughness, float most_roughness, Progress& progress,
                    WorkReport& report);
    /// As if nothing stood in the way. `normal`, `mirrored` unit.
    glm::vec3 radiance(const glm::vec3& normal, const glm::vec3& mirrored, float roughness) const;
    std::size_t bytes() const { return map_.bytes(); }

  private:
    ShellMap map_;
    HorizonTable horizon_;
};

} // namespace kokage
