#include "reflection/sample_plan.h"

#include <algorithm>
#include <cmath>

namespace kokage {

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

double spread_of(const CameraSample* samples, std::size_t count) {
    if (count < 2)
        return 0;
    glm::dvec3 mean(0.), variance(0.);
    for (std::size_t k = 0; k < count; ++k)
        mean += displayable(samples[k].seen.radiance) / double(count);
    for (std::size_t k = 0; k < count; ++k) {
        const glm::dvec3 apart = displayable(samples[k].seen.radiance) - mean;
        variance += apart * apart / double(count - 1);
    }
    return (std::sqrt(variance.r) + std::sqrt(variance.g) + std::sqrt(variance.b)) / 3;
}

} // namespace kokage
