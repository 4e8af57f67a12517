#pragma once
// `kokage bench foliage`: the methods of shading against path tracing, in time, memory and error.
#include "common/services/progress.h"
#include "tests/benchmark/benchmark_plan.h"

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <vector>

namespace kokage {

struct FoliageBenchmarkOptions {
    std::filesystem::path output_folder = "."; ///< foliage.json, foliage.md and plots; made if missing
    bool quick = false;                        ///< within two minutes on two cores, with stored references
    std::filesystem::path data_folder;         ///< environments; empty = the environment variable KOKAGE_DATA, if set
    std::filesystem::path references_folder;   ///< stored references; empty = those of the source this was built from
    std::filesystem::path cache_folder;        ///< references made here; empty = output_folder/references
    std::uint64_t reference_paths = 1024;      ///< paths a leaf side of references that must be made
    int threads = 0;                           ///< 0 = all cores
    bool plots = true;
};

/// Measures, and writes after every scene what is known so far: foliage.json (an array of records), foliage.md (tables,
/// and figures beside their targets) and foliage-*.svg (by gnuplot; skipped, and said so, where that is missing). Files
/// are replaced whole. `out` gets progress in words and the summary. Returns 0; 1 if a measurement failed (the others
/// are still made).
int run_foliage_benchmark(const FoliageBenchmarkOptions& options, Progress& progress, std::ostream& out);

/// The same with scenes and efforts of one's own (`options.quick` is not looked at).
int run_foliage_benchmark(const std::vector<PlannedScene>& plan, const FoliageBenchmarkOptions& options,
                          Progress& progress, std::ostream& out);

} // namespace kokage
