#include "foliage/bundles/bounce_sweeps.h"

#include "common/services/parallel.h"
#include "foliage/bundles/anderson.h"
#include "foliage/bundles/ray_ends.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace kokage::bundles {
namespace {

/// Sides: waking a thread for less costs more than it saves.
constexpr std::size_t kSideBlock = 1 << 17;
/// Share of light that bounces hand on from which acceleration pays.
constexpr double kStrongBounces = 0.4;

double largest_albedo(const std::vector<Optics>& optics) {
    double largest = 0;
    for (const Optics& optic : optics) {
        const glm::vec3 albedo = optic.reflectance + optic.transmittance;
        largest = std::max({largest, double(albedo.x), double(albedo.y), double(albedo.z)});
    }
    return largest;
}

double mean_closed(const std::vector<float>& open) {
    double closed = 0;
    for (float share : open)
        closed += 1 - share;
    return open.empty() ? 0 : closed / double(open.size());
}

} // namespace

BounceOperator::BounceOperator(const PatchScene& scene, const BundleTransport& transport)
    : scene_(scene), transport_(transport) {
    if (!transport.ground)
        return;
    ground_links_.assign(2 * scene.patches.size(), 0.f);
    for (const Links::GroundLink& link : transport.links.ground)
        ground_links_[link.side] += 1;
}

std::vector<glm::vec3> BounceOperator::light_ground(const OutsideLight& outside,
                                                    const std::vector<Rgb>& radiance) const {
    const Links& links = transport_.links;
    std::vector<glm::vec3> irradiance = outside.ground_irradiance;
    const float texel_area = transport_.ground->texel * transport_.ground->texel;
    const std::size_t directions = links.ground_begin.size() - 1;
    for (std::size_t d = 0; d < directions; ++d) {
        // A line of this direction stands for a beam of this cross-section and solid angle.
        const float share = links.ground_pixel_area[d] / texel_area * (2 * kPi / float(directions));
        const glm::vec3 hidden = outside.near_radiance[d];
        for (std::uint32_t i = links.ground_begin[d]; i < links.ground_begin[d + 1]; ++i)
            irradiance[links.ground[i].texel] += share * (radiance[links.ground[i].side].vec() - hidden);
    }
    const glm::vec3 to_radiance = scene_.ground->albedo / kPi;
    for (glm::vec3& value : irradiance)
        value = to_radiance * (glm::max(value, 0.f) - outside.open_ground_irradiance);
    return irradiance;
}

std::vector<Rgb> BounceOperator::gather_ground(const std::vector<glm::vec3>& ground_excess) const {
    std::vector<Rgb> sums(ground_links_.size());
    for (const Links::GroundLink& link : transport_.links.ground) {
        Rgb& sum = sums[link.side];
        const glm::vec3& excess = ground_excess[link.texel];
        sum.r += excess.x;
        sum.g += excess.y;
        sum.b += excess.z;
    }
    for (std::size_t s = 0; s < sums.size(); ++s) {
        const float inverse = ground_links_[s] > 0 ? 1 / ground_links_[s] : 0.f;
        sums[s] = {sums[s].r * inverse, sums[s].g * inverse, sums[s].b * inverse, 0};
    }
    gather_ray_ground(transport_.rays, ground_excess, sums);
    return sums;
}

void BounceOperator::add_ground(const SideLight& outside, const std::vector<Rgb>& from_ground,
                                std::vector<Rgb>& irradiance) const {
    irradiance.resize(outside.irradiance.size());
    parallel_blocks(irradiance.size(), kSideBlock, [&](std::size_t from, std::size_t to) {
        for (std::size_t side = from; side < to; ++side) {
            const glm::vec3 ground = kPi * outside.down[side] * from_ground[side].vec();
            irradiance[side] = Rgb::from(glm::max(outside.irradiance[side].vec() + ground, 0.f));
        }
    });
}

const std::vector<float>& BounceOperator::weights_for(const std::vector<float>& open) {
    if (weighed_open_ != open || weights_.size() != open.size()) {
        weights_ = link_weights(transport_.links, open);
        weighed_open_ = open;
    }
    return weights_;
}

HalvesResult BounceOperator::scatter_by_halves(const SideLight (&outside)[2], const std::vector<Optics>& optics,
                                               const SweepResult& light) {
    HalvesResult result;
    result.half_difference.resize(light.radiance.size());
    result.irradiance.resize(light.radiance.size());
    const bool ground = !light.from_ground.empty();
    for (int h = 0; ground && h < 2; ++h)
        add_ground(outside[h], light.from_ground, scratch_[h]);
    scatter_halves(scene_, transport_.links, optics, light.radiance,
                   {{ground ? scratch_[0] : outside[0].irradiance, outside[0].open},
                    {ground ? scratch_[1] : outside[1].irradiance, outside[1].open}},
                   result.half_difference, result.irradiance);
    return result;
}

void BounceOperator::remove_shared_lines(const SideLight (&outside)[2], const std::vector<Optics>& optics,
                                         const std::vector<Rgb>& half_difference, SweepResult& light) {
    std::vector<Rgb>&crossed = scratch_[0], &unused = scratch_[1];
    // A mean: of large trees a quarter will do.
    const std::size_t stride = scene_.patches.size() > 8 * kSweepBlock ? 4 : 1;
    crossed.resize(half_difference.size());
    unused.resize(half_difference.size());
    scatter_halves(scene_, transport_.links, optics, half_difference, {{{}, outside[0].open}, {{}, outside[1].open}},
                   crossed, unused, stride);
    glm::dvec3 shared(0.0), emitted(0.0), bounced(0.0);
    for (std::size_t side = 0; side < light.radiance.size(); ++side) {
        if (scene_.patches[side / 2].kind != PatchKind::leaf || side / 2 / kSweepBlock % stride != 0)
            continue;
        shared += glm::dvec3(crossed[side].vec());
        emitted += glm::dvec3(emitted_[side].vec());
        bounced += glm::dvec3(light.radiance[side].vec() - emitted_[side].vec());
    }
    // What one bounce has too much, all bounces have 1 / (1 - survival) times; and of all radiance, just as much is
    // what sides emit.
    glm::vec3 scale(1.f);
    for (glm::length_t c = 0; c < 3; ++c)
        if (emitted[c] > 0 && bounced[c] > 0)
            scale[c] = float(std::clamp(1 - shared[c] / emitted[c] * (emitted[c] + bounced[c]) / bounced[c], 0.5, 1.5));
    parallel_blocks(light.radiance.size(), kSideBlock, [&](std::size_t from, std::size_t to) {
        for (std::size_t side = from; side < to; ++side) {
            const glm::vec3 first = emitted_[side].vec(), rest = light.radiance[side].vec() - first;
            light.radiance[side] = Rgb::from(first + scale * glm::max(rest, 0.f));
        }
    });
}

void BounceOperator::spread(const std::vector<float>& open, const std::vector<Optics>& optics,
                            std::vector<Rgb>& difference) {
    std::vector<Rgb>& sum = scratch_[0];
    sum.resize(difference.size());
    scatter(scene_, transport_.links, optics, weights_for(open), difference, difference, sum);
    std::swap(difference, sum);
}

double BounceOperator::mean_survival(const SideLight& outside, const std::vector<Optics>& optics) const {
    return largest_albedo(optics) * mean_closed(outside.open);
}

/// What sides send out before anything bounces: emitted_. With `ground`, the ground is lit anew first.
void BounceOperator::emit(const OutsideLight& outside, const std::vector<Optics>& optics, SweepResult& result,
                          bool ground) {
    std::vector<Rgb>& irradiance = scratch_[1];
    if (ground)
        result.from_ground = gather_ground(light_ground(outside, result.radiance));
    emitted_.resize(result.radiance.size());
    if (result.from_ground.empty()) {
        scatter_outside(scene_, optics, outside.irradiance, emitted_);
    } else {
        add_ground(outside, result.from_ground, irradiance);
        scatter_outside(scene_, optics, irradiance, emitted_);
    }
}

/// A first guess: sides emit, and see each other as if they were lit evenly. With the mean share s of its light that a
/// side gets back from sides of radiance 1, all are of radiance (mean emitted) / (1 - s).
void BounceOperator::guess(const OutsideLight& outside, const std::vector<Optics>& optics, SweepResult& result) {
    emit(outside, optics, result, transport_.ground.has_value());
    const auto share = [&](std::size_t side) {
        const Optics& optic = optics[scene_.patches[side / 2].optics];
        return optic.reflectance * (1 - outside.open[side]) + optic.transmittance * (1 - outside.open[side ^ 1]);
    };
    glm::dvec3 emitted(0.0), returned(0.0);
    std::size_t sides = 0;
    for (std::size_t side = 0; side < result.radiance.size(); ++side)
        if (scene_.patches[side / 2].kind == PatchKind::leaf) {
            emitted += glm::dvec3(emitted_[side].vec());
            returned += glm::dvec3(share(side));
            ++sides;
        }
    const double count = double(std::max<std::size_t>(sides, 1));
    const glm::vec3 radiance(emitted / count / glm::max(1.0 - returned / count, 0.05));
    parallel_blocks(result.radiance.size(), kSideBlock, [&](std::size_t from, std::size_t to) {
        for (std::size_t side = from; side < to; ++side)
            result.radiance[side] = Rgb::from(emitted_[side].vec() + share(side) * radiance);
    });
}

/// Sweeps until what is missing is below the tolerance.
void BounceOperator::iterate(const OutsideLight& outside, const std::vector<Optics>& optics, const SweepLimits& limits,
                             SweepResult& result) {
    constexpr int kMostSweeps = 1000;
    const bool plain = limits.max_bounces > 0;
    const double albedo = largest_albedo(optics), survival = std::min(mean_survival(outside, optics), 0.95);
    const bool accelerate = !plain && survival > kStrongBounces; // where little bounces, plain sweeps are as few
    // The ground is lit anew while it still matters. By the last time, it is right within a few percent of little.
    const int ground_sweeps = 2, ground_stride = accelerate ? 2 : 1;
    const int most = plain ? limits.max_bounces : kMostSweeps;
    // Plain sweeps from a guess that is too bright end too bright; each of them costs little and mends much.
    const double tolerance = accelerate ? limits.tolerance : limits.tolerance / 3;
    const std::vector<float>& weights = weights_for(outside.open);
    std::vector<Rgb>& next = scratch_[0];
    next.resize(result.radiance.size());
    AndersonAcceleration acceleration;
    for (int sweep = 0; sweep < most; ++sweep) {
        const bool ground =
            transport_.ground && (plain || (sweep < ground_sweeps * ground_stride && sweep % ground_stride == 0));
        if (ground || sweep == 0)
            emit(outside, optics, result, ground);
        const SweepHistory history = acceleration.history();
        HistoryProducts products;
        const RadianceChange change =
            scatter(scene_, transport_.links, optics, weights, result.radiance, emitted_, next, &history, &products);
        const double residual = change.largest_radiance > 0 ? change.largest / change.largest_radiance : 0.0;
        result.residuals.push_back(residual);
        double missing = 0;
        for (glm::length_t c = 0; c < 3; ++c)
            if (change.total_radiance[c] > 0)
                missing = std::max(missing, change.total[c] / change.total_radiance[c] * survival / (1 - survival));
        // Dense clusters fill slowly when hardly anything absorbs: the largest change must be small against the
        // absorption, too.
        const bool done =
            !plain && missing < tolerance && residual < tolerance * std::clamp(30 * (1 - albedo), 0.025, 3.0);
        if (accelerate && !done && sweep + 1 < most)
            acceleration.advance(result.radiance, next, products);
        else
            std::swap(result.radiance, next);
        if (done)
            return;
    }
}

SweepResult BounceOperator::solve(const OutsideLight& outside, const std::vector<Optics>& optics,
                                  const SweepLimits& limits, const std::vector<Rgb>& start) {
    SweepResult result;
    const bool started = start.size() == outside.irradiance.size();
    result.radiance = started ? start : std::vector<Rgb>(outside.irradiance.size());
    if (result.radiance.empty())
        return result;
    if (!started && limits.max_bounces == 0)
        guess(outside, optics, result);
    iterate(outside, optics, limits, result);
    for (Rgb& value : result.radiance)
        value = Rgb::from(glm::max(value.vec(), 0.f));
    return result;
}

} // namespace kokage::bundles
