#pragma once
// The figures that the benchmark is for, from its records alone.
#include "tests/benchmark/foliage_record.h"

#include <optional>
#include <string>
#include <vector>

namespace kokage {

struct SummaryFigure {
    std::string what; ///< "bundles: CPU of path tracing over CPU of bundles at 6 % MRE, 30000 realistic sky-sun"
    std::optional<double> value;  ///< empty: the records don't show it
    std::string unit;             ///< "x", "ms", "%", ...
    std::optional<double> target; ///< empty: told for information
    bool at_least = false;        ///< the target is a lower bound; else an upper one of the absolute value

    bool met() const;
};

/// CPU of one method over CPU of another at the same MRE on one scene; empty outside of what was measured.
std::optional<double> cpu_ratio(const std::vector<FoliageRecord>& records, const std::string& scene,
                                std::uint32_t leaves, const std::string& material, Method dear, Method cheap,
                                double mre);

std::vector<SummaryFigure> summarise(const std::vector<FoliageRecord>& records);

} // namespace kokage
