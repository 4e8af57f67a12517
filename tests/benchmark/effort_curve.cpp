#include "tests/benchmark/effort_curve.h"

#include <algorithm>
#include <cmath>

namespace kokage {

std::optional<double> cpu_at_error(const std::vector<EffortPoint>& points, double error) {
    std::vector<EffortPoint> usable;
    for (const EffortPoint& point : points)
        if (point.cpu_seconds > 0 && point.error > 0 && std::isfinite(point.cpu_seconds) && std::isfinite(point.error))
            usable.push_back(point);
    // In order of effort, so that a curve which turns back crosses an error more than once and is caught doing so.
    std::sort(usable.begin(), usable.end(),
              [](const EffortPoint& a, const EffortPoint& b) { return a.cpu_seconds < b.cpu_seconds; });
    std::optional<double> cpu;
    for (std::size_t i = 0; i + 1 < usable.size(); ++i) {
        const EffortPoint &a = usable[i], &b = usable[i + 1];
        if ((a.error - error) * (b.error - error) > 0)
            continue;
        const double across = std::log(b.error / a.error);
        const double share = across == 0 ? 1.0 : std::log(error / a.error) / across;
        cpu = std::max(cpu.value_or(0.0), a.cpu_seconds * std::pow(b.cpu_seconds / a.cpu_seconds, share));
    }
    if (usable.size() == 1 && usable[0].error == error)
        cpu = usable[0].cpu_seconds;
    return cpu;
}

} // namespace kokage
