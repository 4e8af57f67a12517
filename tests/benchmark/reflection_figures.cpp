#include "tests/benchmark/reflection_tables.h"
#include "tests/benchmark/target_rows.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

namespace kokage {

namespace {

using Records = std::vector<ReflectionRecord>;
using Field = std::optional<double> ReflectionRecord::*;
using Condition = std::function<bool(const ReflectionRecord&)>;

/// The worst of a field over the records that a condition picks: its largest value (`high`), or its least.
std::optional<double> worst(const Records& records, const Condition& picks, Field field, bool high = true) {
    std::optional<double> result;
    for (const ReflectionRecord& record : records)
        if (picks(record) && record.*field)
            result = !result ? *(record.*field)
                     : high  ? std::max(*result, *(record.*field))
                             : std::min(*result, *(record.*field));
    return result;
}

Condition of(const std::string& experiment, const std::string& method, int size = 0,
             const std::string& environment = "") {
    return [=](const ReflectionRecord& r) {
        return r.experiment == experiment && r.method == method && (size == 0 || r.size == size) &&
               (environment.empty() || r.environment == environment);
    };
}

std::string container_rows(const Records& records) {
    const auto half_shells = [](const std::string& environment) -> Condition {
        return [=](const ReflectionRecord& r) {
            return of("containers", "shells", 0, environment)(r) && r.note.find("half") != std::string::npos;
        };
    };
    std::string text = at_most("shells, half: memory",
                               times(worst(records, half_shells(""), &ReflectionRecord::bytes), 1e-6), 1.5, " MB");
    for (const auto& [environment, mean, most] :
         {std::tuple("photograph", 0.2, 8.0), std::tuple("pattern", 0.05, 3.0)}) {
        const std::string name = std::string("shells between texels, ") + environment;
        text += at_most(name + ", mean", worst(records, half_shells(environment), &ReflectionRecord::mean_error_255),
                        mean, "/255");
        text += at_most(name + ", maximum", worst(records, half_shells(environment), &ReflectionRecord::max_error_255),
                        most, "/255");
    }
    return text;
}

std::string teapot_row(const Records& records) {
    const Condition by_shells = [](const ReflectionRecord& r) {
        return of("teapot", "shells")(r) || of("teapot", "shells-vertex")(r);
    };
    return at_most("teapot through shells, all surroundings and smoothnesses: mean",
                   worst(records, by_shells, &ReflectionRecord::mean_error_255), 0.2, "/255");
}

std::string hdr_rows(const Records& records) {
    const Condition real = [](const ReflectionRecord& r) {
        return of("hdr", "spectral")(r) && r.environment != "sun-1e6";
    };
    const Condition sun = of("hdr", "spectral", 0, "sun-1e6");
    return at_most("spectral, lone 1e6 sun: maximum relative error, permille",
                   times(worst(records, sun, &ReflectionRecord::max_relative_error), 1e3), 3, "") +
           at_most("spectral, three real HDR images: maximum relative error, permille",
                   times(worst(records, real, &ReflectionRecord::max_relative_error), 1e3), 10, "") +
           at_most("spectral, three real HDR images: CPU, 128³", worst(records, real, &ReflectionRecord::cpu_seconds),
                   0.3, " s");
}

/// The least, over all surroundings, of a figure of cmgen's divided by ours.
std::optional<double> least_advantage(const Records& records, const std::string& ours, Field field) {
    std::optional<double> least;
    for (const ReflectionRecord& peer : records) {
        if (peer.experiment != "cmgen" || peer.method != "cmgen" || peer.smoothness || !(peer.*field))
            continue;
        const Condition same = [&](const ReflectionRecord& r) {
            return of("cmgen", ours, 0, peer.environment)(r) && !r.smoothness;
        };
        if (const std::optional<double> mine = worst(records, same, field); mine && *mine > 0)
            least = std::min(least.value_or(HUGE_VAL), *(peer.*field) / *mine);
    }
    return least;
}

std::string cmgen_rows(const Records& records) {
    const Condition whole = [](const ReflectionRecord& r) { return of("cmgen", "spectral")(r) && !r.smoothness; };
    const Condition levels = [](const ReflectionRecord& r) {
        return of("cmgen", "spectral")(r) && r.smoothness.has_value();
    };
    return at_most("GGX cube map of 256²: CPU with reading and writing",
                   worst(records, whole, &ReflectionRecord::cpu_seconds), 0.3, " s") +
           at_most("GGX cube map of 256²: mean error of each filtered level, % of mean radiance",
                   times(worst(records, levels, &ReflectionRecord::mean_error_of_mean), 100), 0.1, " %") +
           at_least("GGX cube map: times less CPU than cmgen",
                    least_advantage(records, "spectral-coarse", &ReflectionRecord::cpu_seconds), 50, "") +
           at_least("the same cube map: times smaller error than cmgen",
                    least_advantage(records, "spectral-coarse", &ReflectionRecord::mean_error_of_mean), 10, "");
}

} // namespace

std::string reflection_figures(const Records& records) {
    return target_head() +
           at_most("table: mean error on the pattern, all thresholds",
                   worst(records, of("tables-2-3", "table", 0, "pattern"), &ReflectionRecord::mean_error_255), 0.05,
                   "/255") +
           at_most("spectral 128³: CPU on one core",
                   worst(records, of("spectral", "spectral", 128), &ReflectionRecord::cpu_seconds), 0.1, " s") +
           at_most("spectral 128³: maximum error at voxels",
                   worst(records, of("spectral", "spectral", 128), &ReflectionRecord::max_error_255), 0.05, "/255") +
           at_most("spectral 128³: set-up, CPU",
                   worst(records, of("spectral", "spectral", 128), &ReflectionRecord::setup_cpu_seconds), 1, " s") +
           at_least("spectral 64³: video on 2 cores",
                    worst(records, of("video", "spectral", 64), &ReflectionRecord::frames_per_second, false), 60,
                    " frames/s") +
           at_least("the same, from file to file",
                    worst(records, of("video", "spectral-files", 64), &ReflectionRecord::frames_per_second, false), 60,
                    " frames/s") +
           hdr_rows(records) + container_rows(records) + teapot_row(records) + cmgen_rows(records);
}

} // namespace kokage
