#pragma once
// "At equal error": log-log interpolation between the measured efforts of a method.
#include <optional>
#include <vector>

namespace kokage {

struct EffortPoint {
    double cpu_seconds = 0, error = 0;
};

/// CPU time at which a method reaches an error: on the line in log-log coordinates between those two points, neighbours
/// in CPU time, whose errors enclose it. Where several pairs enclose it (a curve that is not monotone), the dearest
/// counts. Empty when the error lies outside of what was measured: nothing is extrapolated. Points that are not
/// positive and finite are passed over.
std::optional<double> cpu_at_error(const std::vector<EffortPoint>& points, double error);

} // namespace kokage
