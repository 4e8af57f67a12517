#include "reflection/maps/horizon.h"

#include "common/directions/lobes.h"
#include "common/services/error.h"
#include "reflection/maps/lobe_over_cone.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace kokage {
namespace {

constexpr int kColumns = HorizonTable::columns, kRows = HorizonTable::rows;

/// Angular scale of a lobe; what a table's row is measured in.
double width_of(LobeKind kind, double parameter) {
    return kind == LobeKind::phong ? 1 / std::sqrt(parameter + 1) : parameter * parameter; // GGX: alpha
}

/// Rows are even in the logarithm of the width, from the widest lobe to one so narrow that curvature is nothing to it.
constexpr double kWidest[2] = {1, 1}, kNarrowest[2] = {0.003, 1e-4};
double row_width(LobeKind kind, double row) {
    const int k = kind == LobeKind::ggx;
    return kWidest[k] * std::pow(kNarrowest[k] / kWidest[k], row / (kRows - 1));
}
double row_of_width(LobeKind kind, double width) {
    const int k = kind == LobeKind::ggx;
    return std::clamp((kRows - 1) * std::log(width / kWidest[k]) / std::log(kNarrowest[k] / kWidest[k]), 0.0,
                      kRows - 1.0);
}
double parameter_of_width(LobeKind kind, double width) {
    return kind == LobeKind::phong ? 1 / (width * width) - 1 : std::sqrt(width);
}

/// Columns are even in q/(2+|q|), q = elevation of the lobe's axis above the horizon in widths: from -90 to 90 degrees
/// whatever the width, closer where the lobe is cut.
double column_elevation(double column, double width) {
    const double end = kPiDouble / 2 / width, t = (2 * column / (kColumns - 1) - 1) * end / (2 + end);
    return std::clamp(2 * t / (1 - std::abs(t)) * width, -kPiDouble / 2, kPiDouble / 2);
}
double column_of_elevation(double elevation, double width) {
    const double q = elevation / width, end = kPiDouble / 2 / width;
    const double t = q / (2 + std::abs(q)) * (2 + end) / end;
    return std::clamp(0.5 * (kColumns - 1) * (1 + t), 0.0, kColumns - 1.0);
}

/// The part of a lobe above the horizon, in a frame of its axis z and x towards the normal.
struct ClippedMoments {
    double share = 0;
    double turn = 0;   ///< angle of the mean direction from z, towards the normal
    double across = 0; ///< variance in the plane of axis and normal, as a squared sine from the mean direction
    double along = 0;  ///< along the horizon
};

ClippedMoments clipped_moments(const Lobe& lobe, double elevation) {
    double mass = 0, x = 0, z = 0, xx = 0, yy = 0, zz = 0, xz = 0;
    for (const LobeArc& arc : arcs_in_cone(lobe, kPiDouble / 2 - elevation, kPiDouble / 2, 10)) {
        const double sine = std::sin(arc.angle), cosine = std::cos(arc.angle), b = arc.half_arc;
        // Integrals over the arc of 1, cos, cos² and sin² of the azimuth.
        const double one = 2 * b, cos1 = 2 * std::sin(b), cos2 = b + 0.5 * std::sin(2 * b), sin2 = one - cos2;
        mass += arc.mass * one;
        x += arc.mass * sine * cos1;
        z += arc.mass * cosine * one;
        xx += arc.mass * sine * sine * cos2;
        yy += arc.mass * sine * sine * sin2;
        zz += arc.mass * cosine * cosine * one;
        xz += arc.mass * sine * cosine * cos1;
    }
    if (!(mass > 1e-12)) // nothing is left: where it is does not matter, that it is finite does
        return {0, std::max(-elevation, 0.0), 0, 0};
    const double turn = std::atan2(x, z), c = std::cos(turn), s = std::sin(turn);
    return {mass, turn, (xx * c * c - 2 * xz * c * s + zz * s * s) / mass, yy / mass};
}

/// Variance of a whole lobe along any axis across it: half the mean of sin².
double lobe_variance(const Lobe& lobe) {
    if (lobe.kind == LobeKind::phong)
        return 1 / (lobe.parameter + 3);
    return clipped_moments(lobe, kPiDouble / 2).along;
}

/// GGX lobes by their variance: alpha of a given one.
class GgxByVariance {
  public:
    GgxByVariance() {
        for (int i = 0; i <= kSteps; ++i)
            log_variance_.push_back(std::log(lobe_variance({LobeKind::ggx, std::exp(0.5 * log_alpha(i))})));
    }
    double alpha(double variance) const {
        const double wanted = std::log(variance);
        int i = 1;
        while (i < kSteps && log_variance_[std::size_t(i)] > wanted)
            ++i;
        const double from = log_variance_[std::size_t(i) - 1], to = log_variance_[std::size_t(i)];
        return std::min(1.0, std::exp(log_alpha(i - 1 + (wanted - from) / (to - from))));
    }

  private:
    static constexpr int kSteps = 80;
    static double log_alpha(double step) { return -14 * step / kSteps; }
    std::vector<double> log_variance_; ///< from alpha 1 downwards
};

/// What the table keeps of a lobe whose variance is `ratio` of another's: Phong, that ratio itself; GGX, the ratio of
/// the lobes' alpha.
double kept_ratio(const Lobe& lobe, double whole, double ratio) {
    if (lobe.kind == LobeKind::phong)
        return ratio;
    static const GgxByVariance by_variance;
    return std::min(1.0, by_variance.alpha(ratio * whole) / (lobe.parameter * lobe.parameter));
}

} // namespace

std::string_view horizon_correction_name(HorizonCorrection correction) {
    switch (correction) {
    case HorizonCorrection::none:
        return "none";
    case HorizonCorrection::one_lookup:
        return "one-lookup";
    case HorizonCorrection::two_lookups:
        break;
    }
    return "two-lookups";
}

HorizonCorrection horizon_correction_from_name(std::string_view name) {
    for (const HorizonCorrection correction :
         {HorizonCorrection::none, HorizonCorrection::one_lookup, HorizonCorrection::two_lookups})
        if (horizon_correction_name(correction) == name)
            return correction;
    throw InputError("unknown horizon correction '" + std::string(name) + "': use none, one-lookup or two-lookups");
}

// The clipped lobe K against what stands for it, A: share and mean direction are K's first moments; widths follow from
// its variances `across` and `along` the horizon, r = across/along. For narrow Phong lobes the constants were fitted by
// least squares of K - A over images whose power falls as 1/frequency², in the plane (a Gaussian cut by a straight
// horizon), for horizons from one width above to three below the axis:
//   the best mean turns less than K's by a factor near (1-r)^(1/4): the sharp edge is of high frequency;
//   one lookup has 1 - (1-r)/2 (1.3 - r/2) of the variance along;
//   two have r + 0.12 r (1-r), at +-sqrt(0.72 (1-r)) standard deviations.
// Root mean square errors there, relative to the filtered image's variation: horizon through the axis: none 1.22 (and
// the mass wrong by 2), one lookup by plain moments 0.41, one 0.39, two 0.23; horizon one width below: 0.42, 0.21,
// 0.19, 0.13; two widths below: 0.071, 0.057, 0.046, 0.040. Wide lobes, bent around the sphere, and GGX, whose
// variances tell of its foot more than of its core, were fitted to the mean error over placements in a patchy image
// (tests/unit/reflection/maps_horizon_test.cpp has the figures).
namespace {

struct TwoLookups {
    double spread;   ///< squared distance of the two, in (1-r) variances along
    double turn;     ///< power of (1-r) in the mean's turn
    double variance; ///< added to r + 0.12 r (1-r), in (1-r)
};

TwoLookups two_lookups(LobeKind kind, double width) {
    const bool phong = kind == LobeKind::phong;
    const TwoLookups narrow = phong ? TwoLookups{0.72, 0.25, 0} : TwoLookups{0.4, 0.4, 0.3};
    const TwoLookups wide = {0.72, 0.1, 0.2};
    const double t = std::clamp(phong ? 2 * width * width : (width - 0.15) / 0.25, 0.0, 1.0);
    return {narrow.spread + t * (wide.spread - narrow.spread), narrow.turn + t * (wide.turn - narrow.turn),
            narrow.variance + t * (wide.variance - narrow.variance)};
}

} // namespace

HorizonTable::HorizonTable(LobeKind kind, HorizonCorrection correction) : kind_(kind), correction_(correction) {
    if (correction == HorizonCorrection::none)
        return;
    cells_.resize(std::size_t(kColumns) * kRows);
    for (int row = 0; row < kRows; ++row) {
        const double width = row_width(kind, row);
        const Lobe lobe{kind, parameter_of_width(kind, width)};
        const double whole = lobe_variance(lobe);
        const bool two = correction == HorizonCorrection::two_lookups;
        const TwoLookups fit = two_lookups(kind, width);
        for (int column = 0; column < kColumns; ++column) {
            const ClippedMoments moments = clipped_moments(lobe, column_elevation(column, width));
            glm::vec4& cell = cells_[std::size_t(row) * kColumns + std::size_t(column)];
            const double along = moments.along > 0 ? moments.along : 0.25 * whole;
            const double r = moments.along > 0 ? std::clamp(moments.across / along, 0.0, 1.0) : 0.25;
            const double turn = moments.turn * std::pow(1 - r, two ? fit.turn : 0.25);
            const double variance =
                along * (two ? r + 0.12 * r * (1 - r) + fit.variance * (1 - r) : 1 - 0.5 * (1 - r) * (1.3 - 0.5 * r));
            const double spread = two ? std::sqrt(fit.spread * (1 - r) * along) : 0;
            cell = {moments.share, turn / width, spread / width,
                    kept_ratio(lobe, whole, std::clamp(variance / whole, 1e-3, 1.0))};
        }
    }
}

HorizonLookup HorizonTable::lookup(const glm::vec3& normal, const glm::vec3& mirrored, double parameter) const {
    const float cosine = glm::dot(normal, mirrored);
    const glm::vec3 across = normal - cosine * mirrored; // towards the horizon's far side, along the surface's meridian
    const float sine = glm::length(across);
    // Axis and normal fall together: nothing is clipped, and no direction across is known.
    if (correction_ == HorizonCorrection::none || !(sine > 1e-5f && cosine > -1))
        return {{mirrored, mirrored},
                1,
                float(parameter),
                cosine > 0 || correction_ == HorizonCorrection::none ? 1.f : 0.f};
    const double width = width_of(kind_, parameter);
    const double row = row_of_width(kind_, width);
    const double column = column_of_elevation(std::atan2(double(cosine), double(sine)), width);
    const int r = std::min(int(row), kRows - 2), c = std::min(int(column), kColumns - 2);
    const float fr = float(row - r), fc = float(column - c);
    const glm::vec4* at = cells_.data() + std::size_t(r) * kColumns + std::size_t(c);
    const glm::vec4 cell = glm::mix(glm::mix(at[0], at[1], fc), glm::mix(at[kColumns], at[kColumns + 1], fc), fr);

    const float turn = cell.y * float(width), spread = cell.z * float(width);
    HorizonLookup result;
    const glm::vec3 mean = std::cos(turn) * mirrored + std::sin(turn) / sine * across;
    result.share = cell.x;
    result.parameter = kind_ == LobeKind::phong ? float((parameter + 3) / double(cell.w) - 3)
                                                : float(parameter * std::sqrt(double(cell.w)));
    result.count = correction_ == HorizonCorrection::two_lookups && cell.z > 0.02f ? 2 : 1;
    const glm::vec3 beside = spread / sine * glm::cross(normal, mirrored);
    result.directions[0] = result.count == 2 ? glm::normalize(mean + beside) : mean;
    result.directions[1] = result.count == 2 ? glm::normalize(mean - beside) : mean;
    return result;
}

} // namespace kokage
