#include "reflection/maps/split_surroundings.h"
#include "common/environment/split_lights.h"
#include "common/services/stopwatch.h"
#include "reflection/maps/lobe_width.h"

#include <algorithm>
#include <string>

namespace kokage {

SplitSurroundings split_surroundings(const Environment& surroundings, double least_spread, WorkReport& report) {
    const Stopwatch watch;
    SplitSurroundings result;
    LightSplitting splitting;
    splitting.max_texels = 1 << 20; // pixel by pixel
    LightSplit split = split_lights(surroundings.remainder, splitting);
    std::size_t pixels = 0;
    for (const DistantLight& light : split.lights) {
        result.of_image.push_back(cluster_of(light, least_spread));
        pixels += light.texels.size();
    }
    result.remainder = std::move(split.remainder);
    for (const DistantLight& light : surroundings.distant_lights)
        result.added.push_back(cluster_of(light, least_spread));
    report.counts.push_back({"lights split off", split.lights.size()});
    report.counts.push_back({"pixels of lights", pixels});
    report.stages.push_back({"splitting lights off", watch.cpu(), watch.wall()});
    return result;
}

double least_spread(const TexelLayout& layout) {
    double least = 1;
    for (const float parameter : layout.parameters)
        least = std::min(least, lobe_spread({layout.kind, double(parameter)}));
    return least;
}

void add_lights(const SplitSurroundings& lights, const LobeLights& lobes, std::span<const float> factors,
                float negligible, std::span<glm::vec3> filtered, WorkReport& report) {
    if (lights.of_image.empty() && lights.added.empty())
        return;
    const Stopwatch watch;
    const std::uint64_t evaluated =
        lobes.add(lights.of_image, negligible, factors, filtered) + lobes.add(lights.added, negligible, {}, filtered);
    report.counts.push_back({"lobes of lights", evaluated});
    std::uint64_t all = 0;
    for (const std::vector<ClusterOfLight>* clusters : {&lights.of_image, &lights.added})
        for (const ClusterOfLight& cluster : *clusters)
            all += cluster.points.size() * filtered.size();
    if (evaluated < all)
        report.skips.push_back({"lobes of lights out of reach", "they add less than a millionth of the mean radiance",
                                std::to_string(all - evaluated) + " of " + std::to_string(all) + " lobes"});
    report.stages.push_back({"lobes of lights", watch.cpu(), watch.wall()});
}

} // namespace kokage
