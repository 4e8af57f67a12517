#include "foliage/first_light.h"

#include "common/services/parallel.h"
#include "common/services/stopwatch.h"
#include "foliage/bundles/outside_light.h"
#include "foliage/bundles/ray_link_tracing.h"

#include <algorithm>

namespace kokage {

namespace {

using namespace bundles;

constexpr std::size_t kPatchBlock = 1 << 14;

/// Nearly all lines only show their ends; the fewest that can be had show neighbours as well. Lights are drawn as for
/// dark leaves, whatever the colour: it may change, and nothing is to be drawn anew for that.
BundleEffort effort_of_ends(int directions, std::uint64_t seed) {
    constexpr double kDarkLeaves = 0;
    BundleEffort effort = effort_of_directions(directions, kDarkLeaves, seed);
    BundleSettings& lines = effort.lines;
    const int all = lines.sky_directions + lines.link_directions;
    lines.link_directions = 2;
    lines.sky_directions = all - lines.link_directions;
    lines.link_pixels = lines.sky_pixels;
    return effort;
}

/// Here all lines count, not the link lines alone.
std::vector<std::uint32_t> leaves_too_small(const PatchScene& scene, const Facets& facets, BundleSettings lines) {
    lines.link_directions += lines.sky_directions;
    return leaves_too_small_for_lines(scene, facets, lines);
}

SideIrradiance dark(std::size_t patches) {
    return {std::vector<glm::vec3>(patches, glm::vec3(0.f)), std::vector<glm::vec3>(patches, glm::vec3(0.f))};
}

} // namespace

FirstLightByBundles::FirstLightByBundles(const PatchScene& scene, const GroundCells& ground, int directions,
                                         std::uint64_t seed, Progress& progress, WorkReport& report)
    : seed_(seed), drawn_(scene) {
    const BundleEffort effort = effort_of_ends(directions, seed);
    drawn_.draw(effort, leaves_too_small(scene, drawn_.facets(), effort.lines), progress, report);
    Stopwatch watch;
    const Image black(2, 1, 3);
    open_ = gather_sky_alone(drawn_.facets(), drawn_.transport(), black);
    open_.irradiance = {};
    if (ground.size() > 0)
        ground_ = GroundInView(scene, ground, drawn_.facets(), drawn_.transport(), open_.down);
    report.stages.push_back({"open shares", watch.cpu(), watch.wall()});
}

FirstLight FirstLightByBundles::of(const Environment& environment, double negligible, Progress& progress,
                                   WorkReport& report) {
    const std::size_t patches = drawn_.facets().patch_count;
    const BeamLight beams = drawn_.light(environment, negligible, seed_, progress, report);
    progress.throw_if_stopped();
    const SideLight sky = gather_sky_alone(drawn_.facets(), drawn_.transport(), environment.remainder);
    const bool ground = drawn_.transport().ground.has_value();
    FirstLight light{dark(patches), dark(patches), std::vector<float>(patches), std::vector<float>(patches)};
    parallel_blocks(patches, kPatchBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) {
            const Side front = Side(2 * p), back = front + 1;
            light.sky.front[p] = sky.irradiance[front].vec();
            light.sky.back[p] = sky.irradiance[back].vec();
            light.lights.front[p] = beams.mean(front);
            light.lights.back[p] = beams.mean(back);
            light.open_front[p] = open_.open[front] - (ground ? open_.down[front] : 0.f);
            light.open_back[p] = open_.open[back] - (ground ? open_.down[back] : 0.f);
        }
    });
    return light;
}

SideIrradiance FirstLightByBundles::from_ground(std::span<const glm::vec3> radiance) const {
    const std::size_t patches = drawn_.facets().patch_count;
    SideIrradiance light = dark(patches);
    if (radiance.empty())
        return light;
    parallel_blocks(patches, kPatchBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) {
            const Side front = Side(2 * p), back = front + 1;
            light.front[p] = kPi * open_.down[front] * ground_.mean(front, radiance);
            light.back[p] = kPi * open_.down[back] * ground_.mean(back, radiance);
        }
    });
    return light;
}

void FirstLightByBundles::filled_shares(std::vector<float>& front, std::vector<float>& back) const {
    const std::size_t patches = drawn_.facets().patch_count;
    front.resize(patches);
    back.resize(patches);
    for (std::size_t p = 0; p < patches; ++p) {
        front[p] = 1 - open_.open[2 * p];
        back[p] = 1 - open_.open[2 * p + 1];
    }
}

std::vector<glm::vec3> FirstLightByBundles::bent_normals() const {
    return mean_open_directions(drawn_.facets(), drawn_.transport());
}

std::size_t FirstLightByBundles::bytes() const {
    return drawn_.bytes() + ground_.bytes() + (open_.open.size() + open_.down.size()) * sizeof(float);
}

} // namespace kokage
