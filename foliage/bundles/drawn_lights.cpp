#include "foliage/bundles/drawn_lights.h"

#include "common/services/parallel.h"
#include "common/services/random.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace kokage::bundles {
namespace {

/// A ray costs as much as a few pixels: an eighth of the pixels that a leaf would get, at least 4.
int rays_for(float samples) {
    return std::max(4, int(samples / 8));
}

/// The same place and shape; colour and strength may differ (for regions, which hold both in their texels, they may
/// not).
bool same_shape(const DistantLight& a, const DistantLight& b) {
    auto same_texel = [](const DistantLight::Texel& x, const DistantLight::Texel& y) {
        return x.direction == y.direction && x.irradiance == y.irradiance && x.half_angle == y.half_angle;
    };
    return a.direction == b.direction && a.half_angle == b.half_angle &&
           std::equal(a.texels.begin(), a.texels.end(), b.texels.begin(), b.texels.end(), same_texel);
}

glm::vec3 ratio(const glm::vec3& a, const glm::vec3& b) {
    glm::vec3 result(0.f);
    for (int c = 0; c < 3; ++c)
        result[c] = b[c] > 0 ? a[c] / b[c] : 0.f;
    return result;
}

float projected_share(const Facet& facet, const glm::vec3& direction) {
    return facet.bark ? facet.projected_share(direction) : std::abs(glm::dot(facet.normal, direction));
}

/// Mean open share (0 ... 254) of the leaves and of the bark that a beam met, by projected area. It stands for patches
/// that no line of any beam met, which would stay dark otherwise.
glm::vec2 mean_open_share(const Facets& facets, const OpenFractions& open, std::size_t beam,
                          const glm::vec3& to_light) {
    glm::dvec2 sum(0.0), weight(0.0);
    const std::uint8_t* row = open.near_row(beam);
    for (std::size_t f = 0; f < facets.facets.size(); ++f) {
        if (row[f] == OpenFractions::kUnseen)
            continue;
        const Facet& facet = facets.facets[f];
        const double projected = double(facet.area) * double(facet.projected_share(to_light));
        sum[facet.bark] += projected * row[f];
        weight[facet.bark] += projected;
    }
    return {weight.x > 0 ? float(sum.x / weight.x) : 0.f, weight.y > 0 ? float(sum.y / weight.y) : 0.f};
}

/// Open shares (0 ... 254) of a patch's facets towards the beams of a light. No line may have met a small or steep
/// facet in a beam. What the beam shows of the rest of its patch then stands for it, or what other beams show: petals
/// inside a flower lie in the shade of the others, and as much light as leaves get in the mean would light the flower
/// from within (blossoms of a sixteenth of the mean leaf's area came out 13 % too bright).
class PatchOpenness {
  public:
    PatchOpenness(const Facets& facets, const OpenFractions& open, const std::vector<Beam>& beams,
                  const std::vector<glm::vec2>& mean_open)
        : facets_(facets), open_(open), beams_(beams), mean_open_(mean_open), of_beams_(beams.size()) {}

    void look_at(std::uint32_t patch) {
        summed_ = summed_ && patch == patch_;
        patch_ = patch;
    }
    float of(std::uint32_t facet, std::size_t beam) {
        const std::uint8_t seen = open_.near_row(beam)[facet];
        if (seen != OpenFractions::kUnseen)
            return float(seen);
        if (!summed_)
            sum();
        if (of_beams_[beam].weight > 0)
            return of_beams_[beam].mean();
        return of_all_.weight > 0 ? of_all_.mean() : mean_open_[beam][facets_.facets[facet].bark];
    }

  private:
    struct Sum {
        float open = 0, weight = 0; ///< by projected area
        float mean() const { return open / weight; }
    };

    void sum() {
        summed_ = true;
        of_all_ = {};
        for (std::size_t beam = 0; beam < beams_.size(); ++beam) {
            Sum of_beam;
            for (std::uint32_t f = facets_.patch_first_facet[patch_]; f < facets_.patch_first_facet[patch_ + 1]; ++f) {
                const std::uint8_t seen = open_.near_row(beam)[f];
                if (seen == OpenFractions::kUnseen)
                    continue;
                const Facet& facet = facets_.facets[f];
                const float weight = facet.area * projected_share(facet, beams_[beam].direction_to_light);
                of_beam.open += weight * float(seen);
                of_beam.weight += weight;
            }
            of_beams_[beam] = of_beam;
            of_all_.open += of_beam.open;
            of_all_.weight += of_beam.weight;
        }
    }

    const Facets& facets_;
    const OpenFractions& open_;
    const std::vector<Beam>& beams_;
    const std::vector<glm::vec2>& mean_open_;
    std::uint32_t patch_ = 0;
    bool summed_ = false; ///< the sums below are of patch_
    std::vector<Sum> of_beams_;
    Sum of_all_;
};

} // namespace

DrawnLights::DrawnLights(const PatchScene& scene, const Facets& facets, const std::optional<GroundGrid>& ground)
    : scene_(scene), facets_(facets), ground_(ground) {}

void DrawnLights::clear() {
    distant_.clear();
    points_.clear();
    if (ray_lights_)
        ray_lights_->clear();
}

const DrawnLights::Distant& DrawnLights::draw(const DistantLight& light, const LightEffort& effort,
                                              std::vector<Distant>& kept, std::uint64_t seed) {
    const auto found =
        std::find_if(distant_.begin(), distant_.end(), [&](const Distant& d) { return same_shape(d.light, light); });
    // A light that has become much stronger than it was drawn for is drawn again.
    const float samples = float(effort.beams) * effort.pixels;
    if (found != distant_.end() && samples <= 1.5f * found->samples) {
        kept.push_back(std::move(*found));
        distant_.erase(found);
        return kept.back();
    }
    Distant drawn;
    drawn.light = light;
    // A disc is drawn in white, so that a change of its colour needs nothing new.
    if (light.texels.empty())
        drawn.light.irradiance = glm::vec3(1.f);
    drawn.beams = make_beams(drawn.light, effort.beams, seed);
    for (Beam& beam : drawn.beams)
        if (ground_ && beam.direction_to_light.y <= 0) // the ground is in the way
            beam.irradiance = glm::vec3(0.f);
    std::vector<glm::vec3> directions;
    for (const Beam& beam : drawn.beams)
        directions.push_back(beam.direction_to_light);
    drawn.visibility = trace_beams(scene_, facets_, ground_, directions, effort.pixels, seed);
    drawn.samples = samples;
    drawn.mean_open.resize(directions.size());
    parallel_blocks(directions.size(), 1, [&](std::size_t beam, std::size_t) {
        drawn.mean_open[beam] = mean_open_share(facets_, drawn.visibility.open, beam, directions[beam]);
    });
    drawn_beams_ += directions.size();
    kept.push_back(std::move(drawn));
    return kept.back();
}

void DrawnLights::add(const Distant& drawn, const glm::vec3& scale, BeamLight& sum) const {
    const std::size_t count = drawn.beams.size();
    std::vector<glm::vec3> irradiance(count);
    for (std::size_t beam = 0; beam < count; ++beam)
        irradiance[beam] = scale * drawn.beams[beam].irradiance;
    parallel_blocks(facets_.patch_count, std::size_t(1) << 15, [&](std::size_t from, std::size_t to) {
        PatchOpenness openness(facets_, drawn.visibility.open, drawn.beams, drawn.mean_open);
        for (std::uint32_t f = facets_.patch_first_facet[from]; f < facets_.patch_first_facet[to]; ++f) {
            const Facet& facet = facets_.facets[f];
            if (!(facet.area > 0)) // all hole
                continue;
            openness.look_at(facet.patch);
            const float share = facet.area / facets_.patch_area[facet.patch] / 254;
            for (std::size_t beam = 0; beam < count; ++beam) {
                const float open = openness.of(f, beam);
                if (open == 0)
                    continue;
                const glm::vec3& to_light = drawn.beams[beam].direction_to_light;
                const float cosine = glm::dot(facet.normal, to_light);
                const float projected = projected_share(facet, to_light);
                const Side side = 2 * facet.patch + Side(!facet.bark && cosine < 0);
                const glm::vec3 received = share * projected * open * irradiance[beam];
                Rgb& target = sum.halves[beam & 1][side];
                target = Rgb::from(target.vec() + received);
            }
        }
    });
    for (std::size_t beam = 0; beam < count; ++beam) {
        const glm::vec3 on_ground = 0.5f * irradiance[beam] * std::max(drawn.beams[beam].direction_to_light.y, 0.f);
        sum.open_ground += on_ground;
        if (ground_)
            for (std::size_t texel = 0; texel < sum.ground.size(); ++texel)
                sum.ground[texel] += (1 - drawn.visibility.ground_shadow[beam][texel]) * on_ground;
    }
}

void DrawnLights::add(const PointTransfer& transfer, const glm::vec3& intensity, BeamLight& sum) const {
    for (int h = 0; h < 2; ++h)
        for (std::size_t patch = 0; patch < transfer.halves[h].size(); ++patch)
            for (int k = 0; k < 2; ++k) {
                if (k == 1 && scene_.patches[patch].kind == PatchKind::bark)
                    continue; // inside the wood
                Rgb& target = sum.halves[h][2 * patch + std::size_t(k)];
                target = Rgb::from(target.vec() + transfer.halves[h][patch][k] * intensity);
            }
    for (std::size_t texel = 0; texel < sum.ground.size(); ++texel)
        sum.ground[texel] += transfer.ground[texel] * intensity;
}

void DrawnLights::light_points(const Environment& environment, const BundleEffort& effort, std::uint64_t seed,
                               BeamLight& sum, WorkReport& report) {
    std::vector<PointTransfer> kept;
    std::uint64_t rays = 0;
    for (const PointLight& light : environment.point_lights) {
        if (scene_.ground && light.position.y <= scene_.ground->height_m)
            continue; // the ground is in the way
        const auto found = std::find_if(points_.begin(), points_.end(),
                                        [&](const PointTransfer& p) { return p.position == light.position; });
        if (found != points_.end()) {
            kept.push_back(std::move(*found));
            points_.erase(found);
        } else {
            if (!queries_)
                queries_ = std::make_unique<RayQueries>(scene_);
            const int samples = rays_for(float(effort.light_samples) / float(environment.point_lights.size()));
            kept.push_back(
                trace_point_light(*queries_, facets_, ground_, light.position, samples, hash64(seed + kept.size())));
            rays += kept.back().rays;
        }
        add(kept.back(), light.intensity, sum);
    }
    points_ = std::move(kept);
    if (rays > 0)
        report.counts.push_back({"rays", rays});
}

BeamLight DrawnLights::light(const Environment& environment, const BundleEffort& effort, double negligible,
                             std::uint64_t seed, Progress& progress, WorkReport& report) {
    BeamLight sum;
    for (auto& half : sum.halves)
        half.resize(2 * scene_.patches.size());
    if (ground_)
        sum.ground.assign(ground_->texels(), glm::vec3(0.f));
    const LightPlan plan = plan_lights(environment, effort, negligible);
    if (plan.merged > 0)
        report.skips.push_back({std::to_string(plan.merged) + " weak lights merged into their neighbours",
                                "together they give " + std::to_string(100 * plan.merged_share) + " % of the light",
                                std::to_string(2 * plan.merged) + " rasters"});
    drawn_beams_ = 0;
    if (ray_lights_)
        ray_lights_->begin();
    std::vector<Distant> kept;
    kept.reserve(plan.drawn.size());
    for (const LightEffort& planned : plan.drawn) {
        progress.throw_if_stopped();
        const DistantLight& light = environment.distant_lights[planned.light];
        if (!(luminance(planned.irradiance) > 0))
            continue;
        const Distant& drawn = draw(light, planned, kept, hash64(seed) + planned.light);
        const glm::vec3 scale = ratio(planned.irradiance, drawn.light.irradiance);
        add(drawn, scale, sum);
        if (ray_lights_)
            ray_lights_->add(drawn.light, scale, rays_for(float(planned.beams) * planned.pixels),
                             hash64(seed) + planned.light, progress);
    }
    if (ray_lights_) {
        ray_lights_->finish(sum.halves);
        if (ray_lights_->rays() > 0)
            report.counts.push_back({"light rays from small leaves", ray_lights_->rays()});
    }
    distant_ = std::move(kept);
    report.counts.push_back({"light rasters", drawn_beams_});
    light_points(environment, effort, seed, sum, report);
    return sum;
}

std::size_t DrawnLights::bytes() const {
    std::size_t total = 0;
    for (const Distant& light : distant_)
        total += light.visibility.open.near_end.size() + light.beams.size() * sizeof(Beam) +
                 (ground_ ? light.visibility.ground_shadow.size() * ground_->texels() * sizeof(float) : 0);
    for (const PointTransfer& point : points_)
        total += 2 * point.halves[0].size() * sizeof(glm::vec2) + point.ground.size() * sizeof(float);
    return total;
}

} // namespace kokage::bundles
