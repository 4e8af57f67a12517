#include "tests/benchmark/reflection_record.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace kokage {

namespace {

/// JSON has no NaN or infinity: a figure that is not finite is null, too.
nlohmann::json number(std::optional<double> value) {
    return value && std::isfinite(*value) ? nlohmann::json(*value) : nlohmann::json(nullptr);
}

} // namespace

nlohmann::json to_json(const ReflectionRecord& record) {
    return {
        {"experiment", record.experiment},
        {"environment", record.environment},
        {"method", record.method},
        {"lobe", record.lobe},
        {"size", record.size},
        {"threshold", number(record.threshold)},
        {"smoothness", number(record.smoothness)},
        {"setup_cpu_seconds", number(record.setup_cpu_seconds)},
        {"cpu_seconds", number(record.cpu_seconds)},
        {"wall_seconds", number(record.wall_seconds)},
        {"frames_per_second", number(record.frames_per_second)},
        {"texels", number(record.texels)},
        {"bytes", number(record.bytes)},
        {"mean_error_255", number(record.mean_error_255)},
        {"max_error_255", number(record.max_error_255)},
        {"mean_relative_error", number(record.mean_relative_error)},
        {"max_relative_error", number(record.max_relative_error)},
        {"mean_error_of_mean", number(record.mean_error_of_mean)},
        {"note", record.note},
    };
}

} // namespace kokage
