#include "reflection/sample_plan.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

/// Of the variance between parts: that of evenly spread rays falls with the 3/2th power of their number.
double left_between_parts(int coverage_rays) {
    return std::pow(1. + coverage_rays, -1.5);
}

/// Of a shaded ray with so many coverage rays, over that of a shaded ray. Measured on an oak of 30,000 leaves.
double cost(int coverage_rays) {
    constexpr double kCoverageRay = 0.25;
    return 1 + kCoverageRay * coverage_rays;
}

} // namespace

SamplePlan::SamplePlan(const std::vector<double>& spreads, int samples, int first)
    : first_(first), most_(kMost * samples) {
    if (first >= samples) {
        most_ = first;
        return;
    }
    double largest = 0;
    for (const double spread : spreads)
        largest = std::max(largest, spread);
    if (!(largest > 0))
        return; // nothing varies: the first rays are enough
    const auto mean_count = [&](double scale) {
        scale_ = scale;
        double sum = 0;
        for (const double spread : spreads)
            sum += count(spread);
        return sum / double(spreads.size());
    };
    // The logarithm of the scale, by halving; it ends at the scale of which no pixel gets more than its first rays.
    const double least = std::pow(largest, -2. / 3);
    double low = std::log(least), high = low + 50;
    for (int step = 0; step < 60; ++step) {
        const double middle = 0.5 * (low + high);
        (mean_count(std::exp(middle)) < samples ? low : high) = middle;
    }
    scale_ = std::exp(high);
}

int SamplePlan::first_samples(int samples) {
    return samples < 8 ? samples : std::clamp(samples / 4, 4, 16);
}

int SamplePlan::count(double spread) const {
    const double wanted = spread > 0 ? scale_ * std::pow(spread, 2. / 3) : 0;
    return int(std::clamp(std::round(wanted), double(first_), double(most_)));
}

void RadianceSpread::add(const RadianceSpread& other) {
    all += other.all;
    in_parts += other.in_parts;
    all_freedom += other.all_freedom;
    in_parts_freedom += other.in_parts_freedom;
}

glm::dvec3 RadianceSpread::variance() const {
    return all_freedom > 0 ? all / all_freedom : glm::dvec3(0.);
}

glm::dvec3 RadianceSpread::variance_in_parts() const {
    return in_parts_freedom > 0 ? glm::min(in_parts / in_parts_freedom, variance()) : variance();
}

int RadianceSpread::coverage_rays() const {
    const glm::dvec3 all_parts = variance(), each_part = variance_in_parts();
    const double sum = all_parts.r + all_parts.g + all_parts.b, rest = each_part.r + each_part.g + each_part.b;
    int best = 0;
    double least = sum;
    for (int rays = 1; rays <= kMostCoverageRays; ++rays)
        if (const double product = (rest + left_between_parts(rays) * (sum - rest)) * cost(rays); product < least) {
            best = rays;
            least = product;
        }
    return best;
}

double RadianceSpread::deviation(int coverage_rays) const {
    const glm::dvec3 rest = glm::mix(variance_in_parts(), variance(), left_between_parts(coverage_rays));
    return (std::sqrt(rest.r) + std::sqrt(rest.g) + std::sqrt(rest.b)) / (3 * cost(coverage_rays));
}

RadianceSpread spread_of(std::span<const CameraSample> samples) {
    RadianceSpread spread;
    if (samples.size() < 2)
        return spread;
    // What one ray alone met may be small: such parts are one class (coverage_classes.h).
    struct Class {
        std::uint32_t part;
        double count = 0;
        glm::dvec3 sum{0.};

        bool is_of_its_own() const { return part < seen_part::kFirstSurface || count > 1; }
    };
    std::vector<Class> classes;
    const auto of = [&](const CameraSample& sample) -> Class& {
        for (Class& known : classes)
            if (known.part == sample.seen.part)
                return known;
        return classes.emplace_back(Class{.part = sample.seen.part});
    };
    glm::dvec3 mean(0.);
    for (const CameraSample& sample : samples) {
        const glm::dvec3 radiance = displayable(sample.seen.radiance);
        Class& met = of(sample);
        met.count += 1;
        met.sum += radiance;
        mean += radiance / double(samples.size());
    }
    Class small{.part = seen_part::kFirstSurface};
    std::size_t large = 0;
    for (const Class& met : classes)
        if (met.is_of_its_own()) {
            ++large;
        } else {
            small.count += met.count;
            small.sum += met.sum;
        }
    for (const CameraSample& sample : samples) {
        const Class &met = of(sample), &alike = met.is_of_its_own() ? met : small;
        const glm::dvec3 radiance = displayable(sample.seen.radiance), apart = radiance - mean,
                         within = radiance - alike.sum / alike.count;
        spread.all += apart * apart;
        spread.in_parts += within * within;
    }
    spread.all_freedom = double(samples.size() - 1);
    spread.in_parts_freedom = double(samples.size() - large - (small.count > 0 ? 1 : 0));
    return spread;
}

} // namespace kokage
