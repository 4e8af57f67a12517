#pragma once
// What every method of shading gives: the radiance of both sides of every patch, and how good it is.
#include "common/scene/light_map.h"
#include "common/services/work_report.h"
#include "common/types.h"

#include <optional>
#include <string>
#include <vector>

namespace kokage {

/// Outgoing radiance of the two sides of every patch, in the order of PatchScene::patches.
struct SideRadiance {
    std::vector<glm::vec3> front, back;
};

struct Solution {
    SideRadiance radiance; ///< all light
    SideRadiance indirect; ///< without the unscattered light of the split-off lights (sun, lamps): pictures and engines
                           ///< add their own
    std::vector<float> sky_visibility_front,
        sky_visibility_back;            ///< cosine-weighted share of the side's hemisphere that is open; may be empty
    std::vector<glm::vec3> bent_normal; ///< mean open direction of both sides together, unit or 0; may be empty
    std::vector<LightMap> light_maps;   ///< may be empty
    std::vector<double>
        residuals; ///< per bounce or sweep: largest change of any side's radiance over the largest radiance
    std::optional<double> estimated_error; ///< of the MRE, from differences of half samples, and paths where those do
                                           ///< not see it; empty where samples can't show it
    double energy_in = 0, energy_absorbed = 0,
           energy_escaped = 0;  ///< luminance x sr x m^2: into the tree from outside; balance = (absorbed + escaped)/in
    std::string method_instead; ///< the method that was used in place of the asked one; empty: the asked one
    std::size_t transport_bytes = 0; ///< kept between relights
    WorkReport report;
};

} // namespace kokage
