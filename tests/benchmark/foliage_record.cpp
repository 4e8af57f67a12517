#include "tests/benchmark/foliage_record.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace kokage {

namespace {

/// JSON has no NaN or infinity: a figure that is not finite is null, too.
nlohmann::json number(std::optional<double> value) {
    return value && std::isfinite(*value) ? nlohmann::json(*value) : nlohmann::json(nullptr);
}

} // namespace

nlohmann::json to_json(const FoliageRecord& record) {
    return {
        {"scene", record.scene},
        {"leaves", record.leaves},
        {"material", record.material},
        {"method", method_name(record.method)},
        {"effort", number(record.effort)},
        {"effort_kind", record.effort_kind},
        {"cpu_seconds", number(record.cpu_seconds)},
        {"wall_seconds", number(record.wall_seconds)},
        {"relight_cpu_seconds", number(record.relight_cpu_seconds)},
        {"bytes_per_leaf", number(record.bytes_per_leaf)},
        {"mre", number(record.accuracy.mre)},
        {"rmse_over_mean", number(record.accuracy.rmse_over_mean)},
        {"bias", number(record.accuracy.bias)},
        {"p95", number(record.accuracy.p95)},
        {"maximum_error", number(record.maximum_error)},
        {"estimated_error", number(record.estimated_error)},
        {"reference_noise", number(record.reference_noise)},
        {"relight_mre", number(record.relight_mre)},
        {"paths", number(record.paths)},
        {"judged", record.judged()},
    };
}

} // namespace kokage
