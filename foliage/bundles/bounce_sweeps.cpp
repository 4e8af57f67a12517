#include "foliage/bundles/bounce_sweeps.h"

#include "common/services/parallel.h"
#include "foliage/bundles/anderson.h"
#include "foliage/bundles/ray_ends.h"

#include <algorithm>
#include <cmath>
#include <hwy/highway.h>

namespace kokage::bundles {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Rgb4 = hn::FixedTag<float, 4>; // one side; every instruction set has vectors of four
constexpr std::size_t kPatchBlock = 2048;

/// Sum of the neighbours' radiance over part of a row.
HWY_INLINE hn::Vec<Rgb4> sum_row(const Side* begin, const Side* end, const Rgb* radiance) {
    const Rgb4 d;
    auto even = hn::Zero(d), odd = hn::Zero(d);
    for (; begin + 1 < end; begin += 2) {
        even = hn::Add(even, hn::Load(d, &radiance[begin[0]].r));
        odd = hn::Add(odd, hn::Load(d, &radiance[begin[1]].r));
    }
    if (begin < end)
        even = hn::Add(even, hn::Load(d, &radiance[*begin].r));
    return hn::Add(even, odd);
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

std::vector<Rgb> BounceOperator::scatter(const OutsideLight& outside, const std::vector<Optics>& optics,
                                         const SweepResult& light, int half,
                                         std::vector<Rgb>* irradiance_of_sides) const {
    const Links& links = transport_.links;
    const bool ground = !light.from_ground.empty();
    const std::vector<Rgb>& from_ground = light.from_ground;
    std::vector<Rgb> scattered(light.radiance.size());
    if (irradiance_of_sides)
        irradiance_of_sides->resize(light.radiance.size());
    parallel_blocks(scene_.patches.size(), kPatchBlock, [&](std::size_t from, std::size_t to) {
        const Rgb4 d;
        for (std::size_t patch = from; patch < to; ++patch) {
            hn::Vec<Rgb4> irradiance[2] = {hn::Zero(d), hn::Zero(d)};
            for (std::size_t k = 0; k < 2; ++k) {
                const std::size_t side = 2 * patch + k;
                std::uint32_t begin = links.begin[side], end = links.begin[side + 1];
                const std::uint32_t middle = links.middle[side];
                if (half >= 0 && begin < middle &&
                    middle < end) // a half without neighbours makes do with the whole row
                    (half == 0 ? end : begin) = middle;
                auto& sum = irradiance[k];
                const float share = kPi * (1 - outside.open[side]) / float(end - begin);
                sum = hn::Mul(sum_row(&links.neighbours[begin], links.neighbours.data() + end, light.radiance.data()),
                              hn::Set(d, share));
                sum = hn::Add(sum, hn::Load(d, &outside.irradiance[side].r));
                if (ground)
                    sum = hn::Max(hn::Zero(d), hn::MulAdd(hn::Load(d, &from_ground[side].r),
                                                          hn::Set(d, kPi * outside.down[side]), sum));
            }
            if (irradiance_of_sides)
                for (std::size_t k = 0; k < 2; ++k)
                    hn::Store(irradiance[k], d, &(*irradiance_of_sides)[2 * patch + k].r);
            const Optics& optic = optics[scene_.patches[patch].optics];
            const glm::vec3 rho = optic.reflectance / kPi, tau = optic.transmittance / kPi;
            HWY_ALIGN const float reflectance[4] = {rho.x, rho.y, rho.z, 0},
                                  transmittance[4] = {tau.x, tau.y, tau.z, 0};
            const auto r = hn::Load(d, reflectance), t = hn::Load(d, transmittance);
            hn::Store(hn::MulAdd(r, irradiance[0], hn::Mul(t, irradiance[1])), d, &scattered[2 * patch].r);
            hn::Store(hn::MulAdd(r, irradiance[1], hn::Mul(t, irradiance[0])), d, &scattered[2 * patch + 1].r);
        }
    });
    return scattered;
}

namespace {

struct Change {
    double largest = 0, largest_radiance = 0;
    glm::dvec3 total{0.0}, total_radiance{0.0};
};

Change change_between(const std::vector<Rgb>& before, const std::vector<Rgb>& after) {
    const std::size_t blocks = (after.size() + 8191) / 8192;
    std::vector<Change> parts(blocks);
    parallel_blocks(after.size(), 8192, [&](std::size_t from, std::size_t to) {
        float largest = 0, largest_radiance = 0;
        glm::vec3 total(0.f), total_radiance(0.f);
        for (std::size_t s = from; s < to; ++s) {
            const glm::vec3 radiance = after[s].vec(), step = glm::abs(radiance - before[s].vec());
            largest = std::max({largest, step.x, step.y, step.z});
            largest_radiance = std::max({largest_radiance, radiance.x, radiance.y, radiance.z});
            total += step;
            total_radiance += radiance;
        }
        parts[from / 8192] = {largest, largest_radiance, glm::dvec3(total), glm::dvec3(total_radiance)};
    });
    Change change;
    for (const Change& part : parts) {
        change.largest = std::max(change.largest, part.largest);
        change.largest_radiance = std::max(change.largest_radiance, part.largest_radiance);
        change.total += part.total;
        change.total_radiance += part.total_radiance;
    }
    return change;
}

/// An accelerated step, unless it overshoots: where hardly anything absorbs, it may land far below zero, and light
/// never is negative. Then the plain step.
std::vector<Rgb> plausible(std::vector<Rgb> accelerated, const std::vector<Rgb>& plain) {
    glm::dvec3 positive(0.0), negative(0.0);
    for (const Rgb& value : accelerated) {
        positive += glm::dvec3(glm::max(value.vec(), 0.f));
        negative -= glm::dvec3(glm::min(value.vec(), 0.f));
    }
    for (int c = 0; c < 3; ++c)
        if (negative[c] > 0.1 * positive[c])
            return plain;
    return accelerated;
}

double largest_albedo(const std::vector<Optics>& optics) {
    double largest = 0;
    for (const Optics& optic : optics) {
        const glm::vec3 albedo = optic.reflectance + optic.transmittance;
        largest = std::max({largest, double(albedo.x), double(albedo.y), double(albedo.z)});
    }
    return largest;
}

} // namespace

void BounceOperator::remove_echoes(const OutsideLight& outside, const std::vector<Optics>& optics,
                                   SweepResult& light) const {
    const Links& links = transport_.links;
    const std::size_t sides = light.radiance.size();
    // What one line adds to a side's radiance, by share of the row: k = rho (1 - open) / (lines - 1), and the row's
    // mean m.
    std::vector<Rgb> echo(sides), echo_mean(sides);
    auto row_mean = [&](std::size_t side, const Rgb* values) {
        const Rgb4 d;
        Rgb sum;
        const std::uint32_t begin = links.begin[side], end = links.begin[side + 1];
        hn::Store(sum_row(&links.neighbours[begin], links.neighbours.data() + end, values), d, &sum.r);
        return sum.vec() / float(end - begin);
    };
    parallel_blocks(sides, 2 * kPatchBlock, [&](std::size_t from, std::size_t to) {
        for (std::size_t side = from; side < to; ++side) {
            const std::uint32_t lines = links.begin[side + 1] - links.begin[side];
            if (lines < 2)
                continue;
            const glm::vec3 rho = optics[scene_.patches[side / 2].optics].reflectance;
            const glm::vec3 share = rho * (1 - outside.open[side]) / float(lines - 1);
            echo[side] = Rgb::from(share);
            echo_mean[side] = Rgb::from(share * row_mean(side, light.radiance.data()));
        }
    });
    clear_ray_sides(transport_.rays, echo);
    clear_ray_sides(transport_.rays, echo_mean);
    std::vector<Rgb> irradiance(sides);
    parallel_blocks(sides, 2 * kPatchBlock, [&](std::size_t from, std::size_t to) {
        for (std::size_t side = from; side < to; ++side) {
            const glm::vec3 excess =
                row_mean(side, echo_mean.data()) - row_mean(side, echo.data()) * light.radiance[side].vec();
            irradiance[side] = Rgb::from(kPi * (1 - outside.open[side]) * excess);
        }
    });
    clear_ray_sides(transport_.rays, irradiance);
    std::vector<Rgb> correction(sides);
    for (std::size_t patch = 0; patch < scene_.patches.size(); ++patch) {
        const Optics& optic = optics[scene_.patches[patch].optics];
        const glm::vec3 rho = optic.reflectance / kPi, tau = optic.transmittance / kPi;
        const glm::vec3 front = irradiance[2 * patch].vec(), back = irradiance[2 * patch + 1].vec();
        correction[2 * patch] = Rgb::from(rho * front + tau * back);
        correction[2 * patch + 1] = Rgb::from(rho * back + tau * front);
    }
    constexpr int kOrders = 2;
    correction = spread(outside, optics, correction, kOrders);
    for (std::size_t side = 0; side < sides; ++side)
        light.radiance[side] = Rgb::from(glm::max(light.radiance[side].vec() + correction[side].vec(), 0.f));
}

std::vector<Rgb> BounceOperator::spread(const OutsideLight& outside, const std::vector<Optics>& optics,
                                        const std::vector<Rgb>& difference, int orders) const {
    OutsideLight none;
    none.irradiance.resize(difference.size());
    none.open = outside.open;
    none.down = outside.down;
    SweepResult spreading;
    spreading.radiance = difference;
    for (int order = 0; order < orders; ++order) {
        std::vector<Rgb> scattered = scatter(none, optics, spreading, -1);
        for (std::size_t s = 0; s < scattered.size(); ++s)
            spreading.radiance[s] = Rgb::from(difference[s].vec() + scattered[s].vec());
    }
    return std::move(spreading.radiance);
}

SweepResult BounceOperator::solve(const OutsideLight& outside, const std::vector<Optics>& optics,
                                  const SweepLimits& limits, const std::vector<Rgb>& start) const {
    constexpr int kMostSweeps = 1000;
    constexpr int kAccelerationDepth = 2;
    constexpr int kGroundSweeps =
        3; // by then what the tree sends to the ground is right within a few percent of little
    SweepResult result;
    result.radiance = start.size() == outside.irradiance.size() ? start : std::vector<Rgb>(outside.irradiance.size());
    if (result.radiance.empty())
        return result;
    double closed = 0;
    for (float open : outside.open)
        closed += 1 - open;
    closed /= double(outside.open.size());
    const double albedo = largest_albedo(optics), survival = std::min(albedo * closed, 0.95);
    AndersonAcceleration acceleration(kAccelerationDepth);
    const int most = limits.max_bounces > 0 ? limits.max_bounces : kMostSweeps;
    for (int sweep = 0; sweep < most; ++sweep) {
        if (transport_.ground && (sweep <= kGroundSweeps || limits.max_bounces > 0))
            result.from_ground = gather_ground(light_ground(outside, result.radiance));
        std::vector<Rgb> next = scatter(outside, optics, result, -1);
        const Change change = change_between(result.radiance, next);
        result.residuals.push_back(change.largest_radiance > 0 ? change.largest / change.largest_radiance : 0.0);
        double missing = 0;
        for (int c = 0; c < 3; ++c)
            if (change.total_radiance[c] > 0)
                missing = std::max(missing, change.total[c] / change.total_radiance[c] * survival / (1 - survival));
        // Dense clusters fill slowly when hardly anything absorbs: the largest change must be small against the
        // absorption, too.
        const bool done = limits.max_bounces == 0 && missing < limits.tolerance &&
                          result.residuals.back() < 5 * limits.tolerance * std::max(1 - albedo, 0.005);
        if (done || sweep + 1 == most || limits.max_bounces > 0)
            result.radiance = std::move(next);
        else
            result.radiance = plausible(acceleration.next(result.radiance, next), next);
        if (done)
            break;
    }
    for (Rgb& value : result.radiance)
        value = Rgb::from(glm::max(value.vec(), 0.f));
    if (limits.max_bounces == 0)
        remove_echoes(outside, optics, result);
    return result;
}

} // namespace kokage::bundles
