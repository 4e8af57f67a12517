#pragma once
// `kokage bench trees`: time and memory of growing against the number of leaves, beside other generators.
#include "common/services/progress.h"
#include "tests/benchmark/tree_record.h"

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

namespace kokage {

struct TreesBenchmarkOptions {
    std::filesystem::path output_folder = "."; ///< trees.json, trees.md and plots; made if missing
    bool quick = false;                        ///< two species up to 100,000 leaves: within half a minute
    int threads = 0;                           ///< 0 = all cores
    bool plots = true, peers = true;
};

/// Measures, and writes after every species what is known so far: trees.json (an array of records), trees.md (tables,
/// and figures beside their targets), trees-time.svg and trees-memory.svg (by gnuplot; skipped, and said so, where that
/// is missing). Files are replaced whole. `out` gets progress in words. Returns 0; 1 if a measurement failed (the
/// others are still made).
int run_trees_benchmark(const TreesBenchmarkOptions& options, Progress& progress, std::ostream& out);

/// The same for these species and numbers of leaves (`options.quick` is not looked at but for peers).
int run_trees_benchmark(const std::vector<std::string>& species, const std::vector<int>& leaves,
                        const TreesBenchmarkOptions& options, Progress& progress, std::ostream& out);

/// The median of several times where one takes less than a second.
TreeRecord measure_growth(const std::string& species, int leaves);

} // namespace kokage
