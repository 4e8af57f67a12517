#include "foliage/bundles/model_error.h"

#include "common/services/random.h"
#include "foliage/bundles/half_difference.h"
#include "foliage/bundles/light_shares.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kokage::bundles {
namespace {

/// Crowns like the benchmark's and grown oaks from 2,500 leaves on: solid leaves of about one size. Their model error
/// came to 0.9 ... 1.7 % (realistic leaves) and 1.0 ... 2.5 % (bright ones) under sun and sky. In others (cards with
/// holes, leaves as large as branches, low-poly solids) it was anything from 0.6 to 12 %.
bool is_ordinary_crown(const PatchScene& scene, const Facets& facets) {
    constexpr std::uint32_t kLeastLeaves = 2500;
    constexpr double kSpread = 8, kStrangeShare = 0.002;
    if (scene.leaf_count < kLeastLeaves)
        return false;
    std::size_t leaves = 0, strange = 0;
    for (std::size_t p = 0; p < scene.patches.size(); ++p) {
        const Patch& patch = scene.patches[p];
        if (patch.kind != PatchKind::leaf)
            continue;
        bool masked = false;
        for (std::uint32_t t = 0; t < patch.triangle_count; ++t)
            masked = masked || scene.masked(patch.first_triangle + t);
        const float area = facets.patch_area[p];
        ++leaves;
        strange += masked || area * kSpread < facets.mean_leaf_area || area > kSpread * facets.mean_leaf_area;
    }
    return double(strange) <= kStrangeShare * double(leaves);
}

bool same_optics(const std::vector<Optics>& a, const std::vector<Optics>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Optics& x, const Optics& y) {
        return x.reflectance == y.reflectance && x.transmittance == y.transmittance;
    });
}

} // namespace

ModelError::ModelError(const PatchScene& scene, const Facets& facets, double assumed)
    : scene_(scene), assumed_(assumed),
      largest_(is_ordinary_crown(scene, facets) ? 2.1 * assumed : std::numeric_limits<double>::infinity()) {}

ModelError::Conditions ModelError::conditions(const LightAndMatter& now) {
    if (!centre_) {
        glm::dvec3 sum(0.0);
        for (const glm::vec3& position : scene_.positions)
            sum += glm::dvec3(position);
        centre_ = glm::vec3(sum / double(std::max<std::size_t>(scene_.positions.size(), 1)));
    }
    Conditions conditions;
    for (const DistantLight& light : now.environment.distant_lights)
        conditions.lights.push_back(light.direction);
    for (const PointLight& light : now.environment.point_lights)
        conditions.lights.push_back(light.position);
    conditions.shares = light_shares(now.environment, *centre_, scene_.ground.has_value());
    conditions.optics = now.optics;
    return conditions;
}

/// The share of light that comes from elsewhere; 1 if a light moved or leaves changed.
double ModelError::moved(const Conditions& before, const Conditions& now) {
    return before.lights == now.lights && same_optics(before.optics, now.optics)
               ? moved_light(before.shares, now.shares)
               : 1.0;
}

SolutionError ModelError::error(double sampling_error) const {
    constexpr double kLeast = 0.25; // of the sampling error's square, if halves differ by more than paths confirm
    const double sampling = sampling_error * sampling_error;
    return {std::sqrt(std::max(sampling + measured_->beyond, kLeast * sampling)),
            std::sqrt(std::max(measured_->beyond, 0.0)), true};
}

/// 1 in ordinary light. Light that differs a fifth as much from line to line as it usually does, or less, is that much
/// more even over a side, too: in a furnace it is the same everywhere.
double ModelError::evenness(const SamplingError& sampling) {
    return sampling.usual > 0 ? std::min(5 * sampling.shown / sampling.usual, 1.0) : 1.0;
}

std::optional<SolutionError> ModelError::known(const SamplingError& sampling, const LightAndMatter& now) {
    constexpr double kTolerated = 1.35, kMuchMoved = 1.0 / 7;
    const double model = evenness(sampling) * assumed_, all = std::hypot(sampling.shown, model);
    if (std::isfinite(largest_) && std::hypot(sampling.shown, evenness(sampling) * largest_) < kTolerated * all)
        return SolutionError{all, model, false};
    if (!measured_ || moved(measured_->conditions, conditions(now)) > kMuchMoved)
        return {};
    return error(sampling.shown);
}

SolutionError ModelError::measure(const SamplingError& sampling, const std::vector<Rgb>& radiance,
                                  const std::vector<Rgb>& half_differences, const LightAndMatter& now,
                                  std::uint64_t seed, Progress& progress, WorkReport& report) {
    if (!paths_)
        paths_ = std::make_unique<ErrorByPaths>(scene_);
    Measured next;
    next.conditions = conditions(now);
    if (measured_ && moved(measured_->conditions, next.conditions) == 0)
        next = *measured_;
    const std::uint64_t other_seed = next.times == 0 ? seed : hash64(seed + std::uint64_t(next.times));
    const MeasuredError found =
        paths_->measure({leaf_sides(scene_, radiance), leaf_sides(scene_, half_differences)}, now.environment,
                        now.optics, now.max_bounces, other_seed, next.traced, progress);
    report.counts.push_back({"paths that checked the error", found.paths});
    // What both ways say, each weighted by how well it knows; the halves don't see the model error, so that their word
    // counts only where paths are uncertain.
    const double guess = std::isfinite(largest_) ? 0.2 : 0.3; // how far off the assumed error would be, about
    const double trust = 1 / (1 + std::pow(found.uncertainty / guess, 4));
    next.beyond = trust * (found.error * found.error - sampling.shown * sampling.shown) +
                  (1 - trust) * std::pow(evenness(sampling) * assumed_, 2);
    ++next.times;
    measured_ = std::move(next);
    return error(sampling.shown);
}

} // namespace kokage::bundles
