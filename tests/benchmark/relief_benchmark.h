#pragma once
// `kokage bench relief`: reads, time, memory and wrong hits of ray casting on height fields, side by side.
#include "common/services/progress.h"

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

namespace kokage {

struct ReliefBenchmarkOptions {
    std::filesystem::path output_folder = "."; ///< relief.json, relief.md, plots and pictures; made if missing
    std::filesystem::path data_folder{};       ///< with textures; empty: procedural maps alone
    bool quick = false;                        ///< a tenth of the rays: within two minutes on 2 cores
    int threads = 0;                           ///< 0 = all cores; methods are timed on one all the same
    bool plots = true;
    std::vector<std::string> experiments{}; ///< by name; empty = all
};

/// Names that `experiments` may have, in the order in which they run.
std::vector<std::string> relief_experiment_names();

/// Measures, and writes after every experiment what is known so far: relief.json (an array of records), relief.md,
/// relief-reads.svg, pictures. Returns 0; 1 if a measurement failed (the others are still made).
int run_relief_benchmark(const ReliefBenchmarkOptions& options, Progress& progress, std::ostream& out);

} // namespace kokage
