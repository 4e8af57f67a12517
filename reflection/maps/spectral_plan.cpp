#include "reflection/maps/spectral_plan.h"
#include "common/directions/lobes.h"
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
constexpr double kSharedTable = 1.2;  ///< of those that can't be made together
constexpr double kLeastPixels = 0.7;  ///< standard width of a lobe in harmonics
constexpr double kLargestOverRms = 5;
constexpr int kLeastSplitBands = 384;
constexpr double kLeastSharpest = 10; ///< images that are coarser than so smooth a part are summed pixel by pixel
constexpr double kNearShare = 0.2;    ///< of the tolerance: what is left out beyond the near part's reach
constexpr double kLeastShare = 1e-13; ///< of a narrow Phong lobe's peak, of pixels that count
constexpr std::size_t kShareSteps = 1 << 13; ///< linear interpolation of logarithms: relative error 1e-6
constexpr double kLeastRoughness = 5e-4;     ///< below it floats don't tell lobes apart from the mirror
// Shares of the tolerance, chosen by measuring each part's error. What grids blur stays beside the bright; what the
// bands leave out rings all over the sphere, and is seen in the dark if there is anything bright.
constexpr double kGridsShare = 0.6, kEvenBandsShare = 0.6, kBandsShare = 0.08;
constexpr double kStepAtTolerance = 0.2, kToleranceOfStep = 1e-4; ///< between shells, in the logarithm of the width

double least_roughness(double parameter) {
    return std::max(parameter, kLeastRoughness);
}

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

/// The logarithm of its variance; of lobes that are split, the smooth part's, which no narrower lobe falls below.
double SpectralPlan::lobe_width(float parameter) const {
    return std::log(std::max(lobe_spread({kind_, double(parameter)}), 1e-30) + smooth_spread());
}

Lobe SpectralPlan::lobe_of_place(double width) const {
    return lobe_of_spread(kind_, std::max(std::exp(width) - smooth_spread(), 1e-14));
}

/// Normalised to mass 1.
std::vector<double> SpectralPlan::coefficients(const Lobe& lobe, int bands) const {
    if (!(sharpest_ > 0))
        return lobe_coefficients(lobe, bands);
    std::vector<double> k = ggx_smooth_part(bands, least_roughness(lobe.parameter), sharpest_);
    const double mass = k[0];
    for (double& value : k)
        value /= mass;
    return k;
}

void SpectralPlan::tabulate_shares(float least_parameter) {
    least_log_roughness_ = std::log(least_roughness(least_parameter));
    log_shares_.resize(kShareSteps + 1);
    for (std::size_t i = 0; i <= kShareSteps; ++i)
        log_shares_[i] =
            std::log(ggx_smooth_share(std::exp(least_log_roughness_ * (1 - double(i) / kShareSteps)), sharpest_));
}

double SpectralPlan::smooth_share(float parameter) const {
    if (log_shares_.empty())
        return 1;
    const double share = 1 - std::log(least_roughness(parameter)) / least_log_roughness_;
    const double place = std::clamp(share, 0.0, 1.0) * kShareSteps;
    const auto step = std::min(std::size_t(place), kShareSteps - 1);
    return std::exp(std::lerp(log_shares_[step], log_shares_[step + 1], place - double(step)));
}

NearLobe SpectralPlan::near_part(float parameter) const {
    if (is_near_only(parameter)) {
        const Lobe lobe{kind_, kind_ == LobeKind::phong ? double(parameter) : least_roughness(parameter)};
        return {lobe, 0, kind_ == LobeKind::phong ? 0.5 * lobe_reach(lobe, kLeastShare) : 1};
    }
    if (!(sharpest_ > 0))
        return {{kind_, double(parameter)}, 0, 0};
    // Beyond b = sharpest (u+w) the near part's mass is at most exp(-b).
    const double roughness = least_roughness(parameter), u = 1 / ggx_falloff(roughness);
    const double reach = -std::log(kNearShare * tolerance_) / sharpest_ - u;
    return {{kind_, roughness}, sharpest_, std::clamp(reach, 0.0, 1.0)};
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
        const std::vector<double> k = coefficients(lobe, tried);
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
    SpectralShell shell{lobe, coefficients(lobe, bands_needed(lobe, kBandsShare)), 0, 0};
    shell.even_bands = bands_needed(lobe, kEvenBandsShare);
    shell.rings = rings_needed(shell.zonal);
    shells_.push_back(std::move(shell));
}

SpectralPlan::SpectralPlan(const TexelLayout& layout, int image_width, int image_height, double tolerance)
    : kind_(layout.kind), tolerance_(tolerance),
      noise_(2.0 / 12 / (double(image_width) * image_height)), // of noise that is even over [0, 1]
      most_bands_(kMostBands) {
    if (layout.parameters.empty())
        return;
    const double pixel = std::max(kPiDouble / image_height, 2 * kPiDouble / image_width);
    const auto [least, most] = std::minmax_element(layout.parameters.begin(), layout.parameters.end());
    find_narrowest(std::min(lobe_width(*least), lobe_width(*most)), pixel);
    if (const double limit = 1 / (kLeastPixels * pixel * kLeastPixels * pixel);
        kind_ == LobeKind::ggx && *least < narrowest_ && limit > kLeastSharpest) {
        split_lobes(*least, limit, image_height);
        tabulate_shares(*least);
    }
    add_shells(layout.parameters);
    share_grids();
}

/// The narrowest lobe that the bands suffice for: the width at which they no longer do, by bisection. (Very wide Phong
/// lobes need many bands too, for the edge of their half sphere; those are cut off.)
void SpectralPlan::find_narrowest(double needed, double pixel) {
    auto suffices = [&](double width) {
        return bands_needed(lobe_of_spread(kind_, std::exp(width)), kBandsShare) < most_bands_ - 1;
    };
    double narrow = std::log(1e-9), wide = std::log(0.1);
    needed = std::min(needed, wide);
    if (suffices(needed)) // most often: nothing narrower is asked for
        narrow = wide = needed;
    if (!suffices(wide))
        narrow = wide = std::numeric_limits<double>::infinity();
    while (wide - narrow > 1e-2) {
        const double middle = 0.5 * (narrow + wide);
        (suffices(middle) ? wide : narrow) = middle;
    }
    // Nor one that is not wider than the pixels are apart.
    narrowest_ =
        float(lobe_of_spread(kind_, std::exp(std::max(wide - 1e-3, 2 * std::log(kLeastPixels * pixel)))).parameter);
}

/// The sharpest lobes of GGX's mixture that the bands suffice for, and that are wider than the pixels are apart.
void SpectralPlan::split_lobes(float least_parameter, double limit, int image_height) {
    narrowest_ = 0;
    most_bands_ = std::clamp(3 * image_height / 4, kLeastSplitBands, kMostBands); // more pixels nearby cost more
    const Lobe narrowest{kind_, least_roughness(least_parameter)};
    auto suffices = [&](double sharpest) {
        sharpest_ = std::exp(sharpest);
        return bands_needed(narrowest, kBandsShare) < most_bands_ - 1;
    };
    double smooth = std::log(kLeastSharpest), sharp = std::log(limit);
    if (suffices(sharp))
        return;
    while (sharp - smooth > 1e-2) {
        const double middle = 0.5 * (smooth + sharp);
        (suffices(middle) ? smooth : sharp) = middle;
    }
    sharpest_ = std::exp(smooth);
}

/// Neighbours whose grids would be almost as large get grids of one size: one table serves them, a few of them at once.
/// (Smooth parts of narrow lobes are many of about one size.)
void SpectralPlan::share_grids() {
    for (std::size_t end = shells_.size(); end > 0;) {
        std::size_t begin = end - 1;
        const int rings = shells_[begin].rings;
        while (begin > 0 && shells_[begin - 1].rings <= rings &&
               shells_[begin - 1].rings * (end - begin < RingSynthesis::kMostGrids ? kSharedRings : kSharedTable) >=
                   rings)
            shells_[--begin].rings = rings;
        end = begin;
    }
}

void SpectralPlan::add_shells(const std::vector<float>& parameters) {
    float least = std::numeric_limits<float>::max(), most = 0;
    for (const float parameter : parameters)
        if (!is_near_only(parameter)) {
            least = std::min(least, parameter);
            most = std::max(most, parameter);
        }
    if (least > most)
        return; // every texel is near only
    widest_ = std::max(lobe_width(least), lobe_width(most));
    const double range = widest_ - std::min(lobe_width(least), lobe_width(most));
    // Cubic interpolation: the error grows with the fourth power of the step.
    const double step =
        std::clamp(kStepAtTolerance * std::pow(tolerance_ / kToleranceOfStep, 0.25), 0.03, std::log(2.0));
    const auto intervals = std::size_t(std::max(3.0, std::ceil(range / step)));
    std::vector<float> spectral;
    for (const float parameter : parameters)
        if (!is_near_only(parameter))
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
        add_shell(lobe_of_place(widest_ - step_ * double(i)));
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
