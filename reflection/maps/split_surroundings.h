#pragma once
// Surroundings as the fast bakers take them: an image without its lights, and all lights as points whose lobes are
// added one by one. Inside of the bakers alone.
#include "common/environment/environment.h"
#include "common/services/work_report.h"
#include "reflection/maps/lobe_lights.h"

#include <span>
#include <vector>

namespace kokage {

struct SplitSurroundings {
    Image remainder;
    std::vector<ClusterOfLight> of_image; ///< split off it (split_lights.h), every pixel a point at its centre
    std::vector<ClusterOfLight> added;    ///< the distant lights that came beside the image
};

/// Image + lights is exactly what was given. `least_spread`: lobe_spread() of the narrowest lobe. Adds a stage and
/// counts to the report.
SplitSurroundings split_surroundings(const Environment& surroundings, double least_spread, WorkReport& report);

/// lobe_spread() of the narrowest lobe of a layout; 1 for none.
double least_spread(const TexelLayout& layout);

/// filtered += all lights through each texel's lobe, those of the image times factors[texel] (none = 1). Clusters that
/// add less than `negligible` may be left out. Adds a stage, a count and what was skipped to the report.
void add_lights(const SplitSurroundings& lights, const LobeLights& lobes, std::span<const float> factors,
                float negligible, std::span<glm::vec3> filtered, WorkReport& report);

} // namespace kokage
