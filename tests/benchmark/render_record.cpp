#include "tests/benchmark/render_record.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace kokage {
namespace {

nlohmann::json number(const std::optional<double>& value) {
    return value && std::isfinite(*value) ? nlohmann::json(*value) : nlohmann::json(nullptr);
}

} // namespace

bool is_judged(const PictureRecord& record) {
    return record.mean_error && record.reference_noise && *record.reference_noise <= 0.2 * *record.mean_error;
}

nlohmann::json to_json(const PictureRecord& record) {
    return {
        {"scene", record.scene},
        {"method", record.method},
        {"effort", record.effort},
        {"width", record.width},
        {"height", record.height},
        {"samples", record.samples},
        {"asked_error", number(record.error)},
        {"cpu_seconds", number(record.cpu_seconds)},
        {"transport_cpu_seconds", number(record.transport_cpu_seconds)},
        {"solve_cpu_seconds", number(record.solve_cpu_seconds)},
        {"render_cpu_seconds", number(record.render_cpu_seconds)},
        {"mean_error", number(record.mean_error)},
        {"p95_error", number(record.p95_error)},
        {"bias", number(record.bias)},
        {"reference_noise", number(record.reference_noise)},
        {"judged", is_judged(record)},
        {"times_less_cpu_than_path_tracing", number(record.times_less_cpu_than_path_tracing)},
        {"mean_error_of", record.mean_error_of},
        {"bias_of", record.bias_of},
        {"systematic_error_of", record.systematic_error_of},
        {"sampling_error_of", record.sampling_error_of},
        {"share_of", record.share_of},
        {"bias_by_light", record.bias_by_light},
        {"change_by_skip", number(record.change_by_skip)},
        {"note", record.note},
    };
}

} // namespace kokage
