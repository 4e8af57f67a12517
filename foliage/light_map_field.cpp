#include "foliage/light_map_field.h"
#include "common/directions/lobes.h"
#include "common/directions/spherical_harmonics.h"
#include "common/directions/window.h"
#include "common/services/error.h"
#include "common/services/parallel.h"
#include "foliage/map_reading.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace kokage {

namespace {

constexpr int kMostBands = 40;
constexpr double kRoundingMargin = 2e-6;  // so that rounding cannot make an iteration grow at rho + tau = 1
constexpr float kFlatEnough = 0.98f;      // mean normal's length: about 11 degrees of bend to either side
constexpr float kLeastVisibility = 0.05f; // a map behind leaves still tells something, and shares must not all be 0

LightMapFieldOptions checked(const LightMapFieldOptions& options) {
    if (options.bands < 1 || options.bands > kMostBands)
        throw InputError("light maps of " + std::to_string(options.bands) + " bands are asked for; 1 to " +
                         std::to_string(kMostBands) + " are possible (--bands)");
    if (options.nearest < 1)
        throw InputError("a leaf should read " + std::to_string(options.nearest) +
                         " light maps; it must be at least 1");
    return options;
}

} // namespace

LightMapField::LightMapField(const RayQueries& queries, const GroundCells& ground, const Tree& tree,
                             const LightMapFieldOptions& options, Progress& progress)
    : options_(checked(options)), geometry_(patch_geometry(queries.scene())),
      placement_(place_light_maps(tree, options.maps)), places_(placement_.places),
      window_(window_factors(Window::non_negative, options.bands)), scene_(queries.scene()) {
    if (!options_.readers.empty() && options_.readers.size() != geometry_.centres.size())
        throw std::invalid_argument("LightMapField: " + std::to_string(options_.readers.size()) + " readers for " +
                                    std::to_string(geometry_.centres.size()) + " patches");
    choose_nearest(options.nearest);
    drop_unread();
    maps_ = std::make_unique<CapturedMaps>(queries, ground, places_, options.bands, options.least_directions, progress);
    weigh();
    average_curved();
    captured_ = coefficients_ = MapCoefficients(places_.size(), options.bands);
}

/// The nearest maps of every patch, with shares that fall smoothly to 0 at the distance of the next one, so that the
/// field is continuous: (1 - d^2/r^2)^2.
void LightMapField::choose_nearest(int nearest) {
    const std::size_t patches = geometry_.centres.size();
    per_patch_ = std::min(std::size_t(nearest), places_.size());
    readings_.assign(patches * per_patch_, {});
    if (per_patch_ == 0)
        return;
    parallel_blocks(patches, 512, [&](std::size_t begin, std::size_t end) {
        std::vector<std::pair<float, std::uint32_t>> near(places_.size());
        for (std::size_t p = begin; p < end; ++p) {
            if (!reads(p))
                continue;
            for (std::size_t i = 0; i < near.size(); ++i)
                near[i] = {glm::distance(geometry_.centres[p], places_[i].position), std::uint32_t(i)};
            const std::size_t kept = std::min(per_patch_ + 1, near.size());
            std::partial_sort(near.begin(), near.begin() + std::ptrdiff_t(kept), near.end());
            // Without a next one, all maps count: the reach is twice the farthest.
            const float reach = kept > per_patch_ ? near[per_patch_].first : 2 * near[per_patch_ - 1].first;
            for (std::size_t i = 0; i < per_patch_; ++i) {
                const float t = reach > 0 ? near[i].first / reach : 0;
                readings_[p * per_patch_ + i] = {near[i].second, (1 - t * t) * (1 - t * t)};
            }
            if (!(readings_[p * per_patch_].share > 0)) // all equally far
                for (std::size_t i = 0; i < per_patch_; ++i)
                    readings_[p * per_patch_ + i].share = 1;
        }
    });
}

void LightMapField::drop_unread() {
    std::vector<bool> read(places_.size(), false);
    for (const Reading& reading : readings_)
        if (reading.share > 0)
            read[reading.map] = true;
    std::vector<std::uint32_t> renumbered(places_.size(), 0);
    std::vector<LightMapPlace> kept;
    for (std::size_t i = 0; i < places_.size(); ++i)
        if (read[i]) {
            renumbered[i] = std::uint32_t(kept.size());
            kept.push_back(places_[i]);
        }
    for (Reading& reading : readings_)
        reading.map = renumbered[reading.map];
    unread_ = places_.size() - kept.size();
    places_ = std::move(kept);
}

/// Share of the map's capture rays near the direction of a point that get at least as far as the point.
float LightMapField::visible_share(std::size_t map, const glm::vec3& point) const {
    const glm::vec3 to_point = point - places_[map].position;
    const float distance = glm::length(to_point);
    if (!(distance > 0))
        return 1;
    const CaptureDirections& directions = maps_->directions();
    const std::span<const float> depths = maps_->seen().distances_from(map);
    const int cell = int(directions.cell(to_point / distance)), ring = cell / directions.per_ring,
              step = cell % directions.per_ring;
    int passed = 0, rays = 0;
    for (int r = std::max(0, ring - 1); r <= std::min(directions.rings - 1, ring + 1); ++r)
        for (int s = step - 1; s <= step + 1; ++s) {
            const int wrapped = (s + directions.per_ring) % directions.per_ring;
            passed += depths[std::size_t(r * directions.per_ring + wrapped)] >= 0.95f * distance;
            ++rays;
        }
    return float(passed) / float(rays);
}

void LightMapField::weigh() {
    parallel_blocks(geometry_.centres.size(), 512, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) {
            if (!reads(p))
                continue;
            double sum = 0;
            const std::span<Reading> readings{readings_.data() + p * per_patch_, per_patch_};
            for (Reading& reading : readings) {
                reading.share *= std::max(kLeastVisibility, visible_share(reading.map, geometry_.centres[p]));
                sum += reading.share;
            }
            for (Reading& reading : readings)
                reading.share = float(reading.share / sum);
        }
    });
}

/// A piece of bark may go all around its branch and has no one normal: its irradiance is the mean over its area.
void LightMapField::average_curved() {
    const std::size_t count = sh_count(options_.bands);
    curved_.assign(geometry_.centres.size(), -1);
    std::vector<double> harmonics(count), sums(count);
    for (std::size_t p = 0; p < curved_.size(); ++p) {
        if (!reads(p) || !(geometry_.flatness[p] < kFlatEnough))
            continue;
        std::fill(sums.begin(), sums.end(), 0.0);
        double area = 0;
        const Patch& patch = scene_.patches[p];
        for (std::uint32_t t = patch.first_triangle; t < patch.first_triangle + patch.triangle_count; ++t) {
            const glm::dvec3 normal = twice_area_vector(scene_, t);
            const double twice = glm::length(normal);
            if (!(twice > 0))
                continue;
            evaluate_sh(options_.bands, normal / twice, harmonics);
            area += twice;
            for (std::size_t j = 0; j < count; ++j)
                sums[j] += twice * harmonics[j];
        }
        // There is at least one band. NOLINTNEXTLINE(clang-analyzer-core.DivideZero)
        curved_[p] = std::int32_t(mean_harmonics_.size() / count);
        for (double sum : sums)
            mean_harmonics_.push_back(float(sum / area));
    }
}

void LightMapField::update(const SideRadiance& radiance, std::span<const glm::vec3> ground) {
    captured_ = MapCoefficients(places_.size(), options_.bands);
    maps_->add_surfaces(radiance, ground, captured_);
    coefficients_ = captured_;
    std::vector<double> factors = window_;
    if (options_.gather == GatherRule::cosine) {
        const std::vector<double> cosine = cosine_lobe(options_.bands);
        for (std::size_t l = 0; l < factors.size(); ++l)
            factors[l] *= cosine[l];
    }
    for (double& factor : factors)
        factor *= 1 - kRoundingMargin;
    coefficients_.scale_bands(factors);
}

/// The mixed map, convolved with the cosine, in the direction of either side: even bands are the same for both, odd
/// ones opposite.
std::pair<glm::vec3, glm::vec3> LightMapField::read_cosine(std::size_t patch, std::vector<float>& harmonics) const {
    if (const std::int32_t slot = curved_[patch]; slot >= 0)
        std::copy_n(mean_harmonics_.begin() + std::ptrdiff_t(std::size_t(slot) * harmonics.size()), harmonics.size(),
                    harmonics.begin());
    else
        evaluate_sh(options_.bands, geometry_.normals[patch], harmonics);
    glm::vec3 even{0.f}, odd{0.f};
    for (const Reading& reading : readings(patch))
        for (int l = 0; l < options_.bands; ++l) {
            if (l > 1 && l % 2 != 0)
                continue; // the clamped cosine has none of these
            glm::vec3 sum{0.f};
            for (std::size_t j = sh_index(l, -l); j <= sh_index(l, l); ++j)
                sum += harmonics[j] * coefficients_.at(reading.map, j);
            (l == 1 ? odd : even) += reading.share * sum;
        }
    return {even + odd, even - odd};
}

/// Mixed as eq 4, with shares instead of 1/N; eqs 2-3 choose each map's direction. Radiance.
glm::vec3 LightMapField::read_rule(std::size_t patch, std::vector<float>& harmonics) const {
    glm::vec3 sum{0.f};
    for (const Reading& reading : readings(patch)) {
        const glm::vec3 direction = reading_direction(places_[reading.map], geometry_.centres[patch]);
        if (direction == glm::vec3(0.f)) {
            std::fill(harmonics.begin(), harmonics.end(), 0.f);
            harmonics[0] = 0.5f / std::sqrt(kPi);
        } else
            evaluate_sh(options_.bands, direction, harmonics);
        for (std::size_t j = 0; j < harmonics.size(); ++j)
            sum += reading.share * harmonics[j] * coefficients_.at(reading.map, j);
    }
    return sum;
}

SideIrradiance LightMapField::read() const {
    const std::size_t patches = geometry_.centres.size();
    SideIrradiance result{std::vector<glm::vec3>(patches), std::vector<glm::vec3>(patches)};
    parallel_blocks(patches, 256, [&](std::size_t begin, std::size_t end) {
        std::vector<float> harmonics(sh_count(options_.bands));
        for (std::size_t p = begin; p < end; ++p) {
            if (options_.gather == GatherRule::cosine)
                std::tie(result.front[p], result.back[p]) = read_cosine(p, harmonics);
            else
                result.front[p] = result.back[p] = kPi * read_rule(p, harmonics);
            result.front[p] = glm::max(result.front[p], glm::vec3(0.f)); // rounding: the kernel has zeros
            result.back[p] =
                scene_.patches[p].kind == PatchKind::bark ? glm::vec3(0.f) : glm::max(result.back[p], glm::vec3(0.f));
        }
    });
    return result;
}

SideIrradiance LightMapField::irradiance() const {
    SideIrradiance result = read();
    for (std::size_t p = 0; p < front_scale_.size(); ++p) {
        result.front[p] *= front_scale_[p];
        result.back[p] *= back_scale_[p];
    }
    return result;
}

void LightMapField::set_filled_shares(const std::vector<float>& front, const std::vector<float>& back) {
    const std::vector<glm::vec3> one(scene_.patches.size(), glm::vec3(1.f));
    update({one, one}, {});
    const SideIrradiance seen = read(); // pi x the share that the maps see filled
    front_scale_.resize(one.size());
    back_scale_.resize(one.size());
    const auto scale = [](float filled, float in_maps) {
        return in_maps > 0 ? std::sqrt(filled * kPi / in_maps) * float(1 - kRoundingMargin) : 0.f;
    };
    for (std::size_t p = 0; p < one.size(); ++p) {
        front_scale_[p] = scale(front[p], seen.front[p].r);
        back_scale_[p] = scale(back[p], seen.back[p].r);
    }
    captured_ = coefficients_ = MapCoefficients(places_.size(), options_.bands);
}

std::vector<LightMap> LightMapField::export_maps(std::span<const glm::vec3> sky) const {
    MapCoefficients all = captured_;
    if (!sky.empty())
        maps_->add_sky(sky, all);
    all.scale_bands(window_);
    return maps_->export_maps(all);
}

std::size_t LightMapField::bytes() const {
    return maps_->bytes() + mean_harmonics_.size() * sizeof(float) + readings_.size() * sizeof(Reading) +
           geometry_.centres.size() * 2 * sizeof(glm::vec3);
}

} // namespace kokage
