#include "foliage/bundles/drawn_bundles.h"

#include "common/services/stopwatch.h"
#include "foliage/bundles/ray_link_tracing.h"

#include <utility>

namespace kokage::bundles {

DrawnBundles::DrawnBundles(const PatchScene& scene)
    : scene_(scene), facets_(make_facets(scene)), lights_(scene, facets_, transport_.ground) {}

void DrawnBundles::draw(const BundleEffort& effort, const std::vector<std::uint32_t>& too_small, Progress& progress,
                        WorkReport& report) {
    Stopwatch watch;
    BundleTransport drawn = trace_bundles(scene_, facets_, effort.lines, progress);
    report.stages.push_back({"line bundles", watch.cpu(), watch.wall()});
    if (!too_small.empty() || !facets_.wide_patches.empty()) {
        watch.restart();
        if (!rays_)
            rays_ = std::make_unique<Rays>(scene_);
        add_ray_links(rays_->queries, rays_->points, facets_, too_small, rays_a_side(effort.lines), effort.lines.seed,
                      transport_, drawn, progress);
        report.stages.push_back({"rays", watch.cpu(), watch.wall()});
    }
    lights_.set_ray_lights(nullptr); // they refer to the rays that now go
    ray_lights_.reset();
    effort_ = effort;
    transport_ = std::move(drawn);
    if (!transport_.rays.empty())
        ray_lights_ = std::make_unique<RayLights>(rays_->queries, rays_->points, transport_.rays);
    lights_.set_ray_lights(ray_lights_.get());
    lights_.clear();
}

void DrawnBundles::count(WorkReport& report) const {
    auto count = [&](const char* name, std::uint64_t value) { report.counts.push_back({name, value}); };
    count("line directions", transport_.sky_lines.directions.size() + transport_.link_lines.directions.size());
    count("fragments", transport_.fragments);
    count("links", transport_.links.neighbours.size());
    const RayLinks& rays = transport_.rays;
    if (rays.small_count > 0) {
        count("leaves too small for lines", rays.small_count);
        count("rays from small leaves", rays.rays_of_small());
    }
    if (rays.patches.size() > rays.small_count) {
        count("surfaces too wide for lines", rays.patches.size() - rays.small_count);
        count("rays from wide surfaces", rays.rays_of_wide());
    }
}

std::size_t DrawnBundles::bytes() const {
    return facets_.bytes() + transport_.bytes() + lights_.bytes() + (ray_lights_ ? ray_lights_->bytes() : 0) +
           (rays_ ? rays_->queries.bytes() + rays_->points.bytes() : 0);
}

} // namespace kokage::bundles
