#include "foliage/bundles/bundles.h"

#include "common/services/random.h"
#include "common/services/stopwatch.h"
#include "foliage/accuracy.h"
#include "foliage/bundles/outside_light.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

using namespace bundles;

bool same_place(const DistantLight& a, const DistantLight& b) {
    auto same_texel = [](const DistantLight::Texel& x, const DistantLight::Texel& y) {
        return x.direction == y.direction && x.irradiance == y.irradiance && x.half_angle == y.half_angle;
    };
    return a.direction == b.direction && a.half_angle == b.half_angle && a.irradiance == b.irradiance &&
           std::equal(a.texels.begin(), a.texels.end(), b.texels.begin(), b.texels.end(), same_texel);
}

class BundlesTransport : public Transport {
  public:
    BundlesTransport(const PatchScene& scene, const BundleEffort& effort, const ShadingOptions& options,
                     Progress& progress)
        : scene_(scene), effort_(effort), options_(options), optics_(scene.optics) {
        Stopwatch watch;
        facets_ = make_facets(scene);
        transport_ = trace_bundles(scene, facets_, effort.lines, progress);
        bounces_ = std::make_unique<BounceOperator>(scene, transport_);
        tracing_ = {"transport", watch.cpu(), watch.wall()};
    }

    Solution solve(const Environment& environment, Progress& progress) override;
    void set_optics(const std::vector<Optics>& optics) override { optics_ = optics; }
    std::size_t bytes() const override;

  private:
    struct CachedLight {
        DistantLight light;
        LitBeams beams;
    };
    void trace_lights(const Environment& environment);
    OutsideLight outside(const SkyLight& sky, const SkyLight::PerSide& side, const BeamLight& beams, int half) const;
    void fill(Solution& solution, const SweepResult& light, const OutsideLight& all, const BeamLight& beams) const;

    const PatchScene& scene_;
    BundleEffort effort_;
    ShadingOptions options_;
    std::vector<Optics> optics_;
    Facets facets_;
    BundleTransport transport_;
    std::unique_ptr<BounceOperator> bounces_;
    std::vector<CachedLight> lights_;
    std::vector<Rgb> last_radiance_;
    WorkReport::Stage tracing_;
    bool tracing_reported_ = false;
};

void BundlesTransport::trace_lights(const Environment& environment) {
    std::vector<CachedLight> kept;
    for (const DistantLight& light : environment.distant_lights) {
        const auto found = std::find_if(lights_.begin(), lights_.end(),
                                        [&](const CachedLight& c) { return same_place(c.light, light); });
        if (found != lights_.end()) {
            kept.push_back(std::move(*found));
            lights_.erase(found);
            continue;
        }
        CachedLight cached{light, {}};
        const std::uint64_t seed = hash64(options_.seed) + kept.size();
        cached.beams.beams = make_beams(light, effort_.beams_per_light, seed);
        std::vector<glm::vec3> directions;
        for (const Beam& beam : cached.beams.beams)
            directions.push_back(beam.direction_to_light);
        cached.beams.visibility =
            trace_beams(scene_, facets_, transport_.ground, directions, effort_.beam_pixels, seed);
        kept.push_back(std::move(cached));
    }
    lights_ = std::move(kept);
}

OutsideLight BundlesTransport::outside(const SkyLight& sky, const SkyLight::PerSide& side, const BeamLight& beams,
                                       int half) const {
    OutsideLight light;
    light.open = side.open;
    light.down = side.down;
    light.irradiance = side.irradiance;
    for (std::size_t s = 0; s < light.irradiance.size(); ++s) {
        const glm::vec3 from_lights =
            half < 0 ? 0.5f * (beams.halves[0][s].vec() + beams.halves[1][s].vec()) : beams.halves[half][s].vec();
        light.irradiance[s] = Rgb::from(light.irradiance[s].vec() + from_lights);
    }
    light.near_radiance = sky.near_radiance;
    light.open_ground_irradiance = sky.open_ground_irradiance + beams.open_ground;
    light.ground_irradiance = beams.ground;
    for (glm::vec3& irradiance : light.ground_irradiance)
        irradiance += sky.open_ground_irradiance;
    return light;
}

void BundlesTransport::fill(Solution& solution, const SweepResult& light, const OutsideLight& all,
                            const BeamLight& beams) const {
    const std::size_t patches = scene_.patches.size();
    for (SideRadiance* radiance : {&solution.radiance, &solution.indirect}) {
        radiance->front.resize(patches);
        radiance->back.resize(patches);
    }
    solution.sky_visibility_front.resize(patches);
    solution.sky_visibility_back.resize(patches);
    for (std::size_t p = 0; p < patches; ++p) {
        const Optics& optics = optics_[scene_.patches[p].optics];
        const glm::vec3 front = 0.5f * (beams.halves[0][2 * p].vec() + beams.halves[1][2 * p].vec());
        const glm::vec3 back = 0.5f * (beams.halves[0][2 * p + 1].vec() + beams.halves[1][2 * p + 1].vec());
        solution.radiance.front[p] = light.radiance[2 * p].vec();
        solution.radiance.back[p] = light.radiance[2 * p + 1].vec();
        solution.indirect.front[p] = glm::max(
            light.radiance[2 * p].vec() - (optics.reflectance * front + optics.transmittance * back) / kPi, 0.f);
        solution.indirect.back[p] = glm::max(
            light.radiance[2 * p + 1].vec() - (optics.reflectance * back + optics.transmittance * front) / kPi, 0.f);
        solution.sky_visibility_front[p] = all.open[2 * p];
        solution.sky_visibility_back[p] = all.open[2 * p + 1];
    }
}

/// Half the difference of two independent halves is as large, on average, as the error of their mean.
double half_difference(const PatchScene& scene, const std::vector<Rgb>& a, const std::vector<Rgb>& b,
                       const SideRadiance& mean) {
    auto sides = [&](auto&& value) {
        SideRadiance radiance;
        radiance.front.resize(scene.patches.size());
        radiance.back.resize(scene.patches.size());
        for (std::size_t p = 0; p < scene.patches.size(); ++p) {
            radiance.front[p] = value(2 * p);
            radiance.back[p] = value(2 * p + 1);
        }
        return leaf_side_radiance(scene, radiance);
    };
    const std::vector<glm::vec3> first = sides([&](std::size_t s) { return a[s].vec(); });
    const std::vector<glm::vec3> second = sides([&](std::size_t s) { return b[s].vec(); });
    const std::vector<glm::vec3> whole = leaf_side_radiance(scene, mean);
    if (whole.empty())
        return 0;
    glm::dvec3 average(0.0), error(0.0);
    for (const glm::vec3& value : whole)
        average += glm::dvec3(value) / double(whole.size());
    for (std::size_t i = 0; i < whole.size(); ++i)
        for (int c = 0; c < 3; ++c)
            if (const double floor = std::max(double(whole[i][c]), 0.05 * average[c]); floor > 0)
                error[c] += 0.5 * std::abs(double(first[i][c]) - second[i][c]) / floor;
    return (error.x + error.y + error.z) / (3 * double(whole.size()));
}

Solution BundlesTransport::solve(const Environment& environment, Progress& progress) {
    Solution solution;
    if (!tracing_reported_)
        solution.report.stages.push_back(tracing_);
    tracing_reported_ = true;
    Stopwatch watch;
    auto stage = [&](const char* name) {
        solution.report.stages.push_back({name, watch.cpu(), watch.wall()});
        watch.restart();
        progress.throw_if_stopped();
    };
    trace_lights(environment);
    BeamLight beams;
    beams.halves[0].resize(2 * scene_.patches.size());
    beams.halves[1].resize(2 * scene_.patches.size());
    if (scene_.ground)
        beams.ground.assign(GroundGrid::kSize * GroundGrid::kSize, glm::vec3(0.f));
    for (const CachedLight& light : lights_)
        add_beams(facets_, light.beams, beams);
    stage("lights");
    const SkyLight sky = gather_sky(scene_, facets_, transport_, environment.remainder, beams.open_ground);
    stage("sky");
    const OutsideLight all = outside(sky, sky.all, beams, -1);
    SweepLimits limits;
    limits.tolerance = effort_.tolerance;
    limits.max_bounces = options_.max_bounces;
    const SweepResult light = bounces_->solve(all, optics_, limits, last_radiance_);
    solution.residuals = light.residuals;
    stage("bounces");
    fill(solution, light, all, beams);
    const std::vector<Rgb> first = bounces_->scatter(outside(sky, sky.halves[0], beams, 0), optics_, light, 0);
    const std::vector<Rgb> second = bounces_->scatter(outside(sky, sky.halves[1], beams, 1), optics_, light, 1);
    solution.estimated_error = half_difference(scene_, first, second, solution.radiance);
    last_radiance_ = light.radiance;
    stage("error estimate");
    solution.transport_bytes = bytes();
    solution.report.counts = {{"patches", scene_.patches.size()},
                              {"links", transport_.links.neighbours.size()},
                              {"fragments", transport_.fragments}};
    return solution;
}

std::size_t BundlesTransport::bytes() const {
    std::size_t total = transport_.bytes();
    for (const CachedLight& light : lights_)
        total += light.beams.visibility.open.near_end.size() + light.beams.beams.size() * sizeof(Beam);
    return total;
}

} // namespace

std::unique_ptr<Transport> make_bundles_transport(const PatchScene& scene, const BundleEffort& effort,
                                                  const ShadingOptions& options, Progress& progress) {
    return std::make_unique<BundlesTransport>(scene, effort, options, progress);
}

std::unique_ptr<Transport> make_bundles_transport(const PatchScene& scene, const Tree&, const ShadingOptions& options,
                                                  Progress& progress) {
    BundleEffort effort;
    return make_bundles_transport(scene, effort, options, progress);
}

} // namespace kokage
