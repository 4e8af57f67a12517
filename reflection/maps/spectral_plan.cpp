#include "reflection/maps/spectral_plan.h"
#include "common/directions/ring_transform.h"
#include "common/types.h"
#include "reflection/maps/shell_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kokage {
namespace {

constexpr int kMostBands = 512;
constexpr double kSharedRings = 1.35; ///< grids up to so much finer than needed
constexpr double kLeastPixels = 0.7;  ///< standard width of a lobe in harmonics
constexpr double kLargestOverRms = 5;
// Shares of the tolerance, chosen by measuring each part's error. What grids blur stays beside the bright; what the
// bands leave out rings all over the sphere, and is seen in the dark if there is anything bright.
constexpr double kGridsShare = 0.6, kEvenBandsShare = 0.6, kBandsShare = 0.08;
constexpr double kStepAtTolerance = 0.2, kToleranceOfStep = 1e-4; ///< between shells, in the logarithm of the width

/// A length that transforms fast, and even.
bool is_fast(int n) {
    if (n % 2 != 0)
        return false;
    for (const int factor : {2, 3, 5})
        while (n % factor == 0)
            n /= factor;
    return n == 1;
}

/// Ascending; if there are more than `most`, only so many that it shows.
std::vector<float> distinct(const std::vector<float>& values, std::size_t most) {
    std::vector<float> found;
    for (const float value : values) {
        if (found.size() > most)
            break;
        const auto place = std::lower_bound(found.begin(), found.end(), value);
        if (place == found.end() || *place != value)
            found.insert(place, value);
    }
    return found;
}

} // namespace

double SpectralPlan::lobe_width(float parameter) const {
    return std::log(std::max(lobe_spread({kind_, double(parameter)}), 1e-30));
}

namespace {

/// Variance of band l of the image that errors are estimated for.
double band_variance(int l, double noise) {
    return 0.044 / (l + 1) + noise * l;
}

} // namespace

int SpectralPlan::bands_needed(const Lobe& lobe, double share) const {
    const double allowed = share * tolerance_ / kLargestOverRms;
    for (int tried = std::min(64, most_bands_);; tried = std::min(2 * tried, most_bands_)) {
        const std::vector<double> k = lobe_coefficients(lobe, tried);
        double tail = 0;
        int needed = tried;
        for (; needed > 1; --needed) {
            const double value = k[std::size_t(needed) - 1];
            tail += band_variance(needed - 1, noise_) * value * value;
            if (tail > allowed * allowed)
                break;
        }
        if (2 * needed <= tried || tried == most_bands_)
            return needed;
    }
}

int SpectralPlan::rings_needed(std::span<const double> zonal) const {
    const double allowed = kGridsShare * tolerance_ / kLargestOverRms;
    const int bands = int(zonal.size());
    for (int rings = std::max(bands, 8);; ++rings) {
        if (!is_fast(2 * rings) || rings % 2 != 0)
            continue;
        double sum = 0;
        for (int l = 0; l < bands; ++l) {
            const double error = 0.31 * std::pow(0.5 * l / rings, 4) * zonal[std::size_t(l)];
            sum += 2 * band_variance(l, noise_) * error * error;
        }
        if (sum <= allowed * allowed)
            return rings;
    }
}

void SpectralPlan::add_shell(const Lobe& lobe) {
    SpectralShell shell{lobe, lobe_coefficients(lobe, bands_needed(lobe, kBandsShare)), 0, 0};
    shell.even_bands = bands_needed(lobe, kEvenBandsShare);
    shell.rings = rings_needed(shell.zonal);
    shells_.push_back(std::move(shell));
}

SpectralPlan::SpectralPlan(const TexelLayout& layout, int image_width, int image_height, double tolerance)
    : kind_(layout.kind), tolerance_(tolerance),
      noise_(2.0 / 12 / (double(image_width) * image_height)), // of noise that is even over [0, 1]
      most_bands_(kMostBands) {
    // The narrowest lobe that the bands suffice for: the width at which they no longer do, by bisection. (Very wide
    // Phong lobes need many bands too, for the edge of their half sphere; those are cut off.)
    auto suffices = [&](double width) {
        return bands_needed(lobe_of_spread(kind_, std::exp(width)), kBandsShare) < most_bands_ - 1;
    };
    double narrow = std::log(1e-9), wide = std::log(0.1);
    if (!layout.parameters.empty()) {
        const auto [least, most] = std::minmax_element(layout.parameters.begin(), layout.parameters.end());
        const double needed = std::min({wide, lobe_width(*least), lobe_width(*most)});
        if (suffices(needed)) // most often: nothing narrower is asked for
            narrow = wide = needed;
    }
    if (!suffices(wide))
        narrow = wide = std::numeric_limits<double>::infinity();
    while (wide - narrow > 1e-2) {
        const double middle = 0.5 * (narrow + wide);
        (suffices(middle) ? wide : narrow) = middle;
    }
    // Nor one that is not wider than the pixels are apart.
    const double pixel = std::max(kPiDouble / image_height, 2 * kPiDouble / image_width);
    narrowest_ =
        float(lobe_of_spread(kind_, std::exp(std::max(wide - 1e-3, 2 * std::log(kLeastPixels * pixel)))).parameter);
    add_shells(layout.parameters);
    share_grids();
}

/// Neighbours whose grids would be almost as large get grids of one size: one table serves them.
void SpectralPlan::share_grids() {
    for (std::size_t end = shells_.size(); end > 0;) {
        std::size_t begin = end - 1;
        const int rings = shells_[begin].rings;
        while (begin > 0 && end - begin < RingSynthesis::kMostGrids && shells_[begin - 1].rings <= rings &&
               shells_[begin - 1].rings * kSharedRings >= rings)
            shells_[--begin].rings = rings;
        end = begin;
    }
}

void SpectralPlan::add_shells(const std::vector<float>& parameters) {
    float least = std::numeric_limits<float>::max(), most = 0;
    for (const float parameter : parameters)
        if (!is_direct(parameter)) {
            least = std::min(least, parameter);
            most = std::max(most, parameter);
        }
    if (least > most)
        return; // every texel is direct
    widest_ = std::max(lobe_width(least), lobe_width(most));
    const double range = widest_ - std::min(lobe_width(least), lobe_width(most));
    // Cubic interpolation: the error grows with the fourth power of the step.
    const double step =
        std::clamp(kStepAtTolerance * std::pow(tolerance_ / kToleranceOfStep, 0.25), 0.03, std::log(2.0));
    const auto intervals = std::size_t(std::max(3.0, std::ceil(range / step)));
    std::vector<float> spectral;
    for (const float parameter : parameters)
        if (!is_direct(parameter))
            spectral.push_back(parameter);
    parameters_ = distinct(spectral, intervals + 1);
    if (parameters_.size() <= intervals + 1) {
        std::sort(parameters_.begin(), parameters_.end(),
                  [&](float a, float b) { return lobe_width(a) > lobe_width(b); });
        for (const float parameter : parameters_)
            add_shell({kind_, double(parameter)});
        return;
    }
    shells_a_texel_ = ShellMix::kMost;
    step_ = range / double(intervals);
    for (std::size_t i = 0; i <= intervals; ++i)
        add_shell(lobe_of_spread(kind_, std::exp(widest_ - step_ * double(i))));
}

int SpectralPlan::bands() const {
    std::size_t most = 0;
    for (const SpectralShell& shell : shells_)
        most = std::max(most, shell.zonal.size());
    return int(most);
}

ShellMix SpectralPlan::mix(float parameter) const {
    ShellMix mix;
    if (shells_a_texel_ == 1) {
        const auto found = std::find(parameters_.begin(), parameters_.end(), parameter);
        mix.first = std::size_t(found - parameters_.begin());
        mix.weights[0] = 1;
        return mix;
    }
    // Lagrange's cubic through four neighbours, in the logarithm of the width.
    const double place = std::max(0.0, (widest_ - lobe_width(parameter)) / step_);
    mix.first = std::min(std::size_t(std::max(0.0, std::floor(place) - 1)), shells_.size() - ShellMix::kMost);
    for (std::size_t i = 0; i < ShellMix::kMost; ++i) {
        double weight = 1;
        for (std::size_t j = 0; j < ShellMix::kMost; ++j)
            if (j != i)
                weight *= (place - double(mix.first) - double(j)) / (double(i) - double(j));
        mix.weights[i] = float(weight);
    }
    return mix;
}

} // namespace kokage
