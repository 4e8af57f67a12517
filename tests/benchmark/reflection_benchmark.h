#pragma once
// `kokage bench reflection`: time, memory and error of making and using reflection maps, side by side.
#include "common/services/progress.h"

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

namespace kokage {

struct ReflectionBenchmarkOptions {
    std::filesystem::path output_folder = "."; ///< reflection.json, reflection.md and plots; made if missing
    std::filesystem::path data_folder{};       ///< with env and objects; empty: synthetic surroundings alone
    bool quick = false;                        ///< smaller samples: within two minutes on 2 cores
    int threads = 0;                           ///< 0 = all cores; times of one core are taken on one all the same
    bool plots = true;
    std::vector<std::string> experiments{}; ///< by name; empty = all
};

/// Names that `experiments` may have, in the order in which they run.
std::vector<std::string> reflection_experiment_names();

/// Measures, and writes after every experiment what is known so far: reflection.json (an array of records),
/// reflection.md, reflection-error.svg. `out` gets progress in words. Returns 0; 1 if a measurement failed (the others
/// are still made).
int run_reflection_benchmark(const ReflectionBenchmarkOptions& options, Progress& progress, std::ostream& out);

} // namespace kokage
