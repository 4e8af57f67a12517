#include "tests/benchmark/trees_benchmark.h"
#include "common/services/count_text.h"
#include "common/services/parallel.h"
#include "common/services/stopwatch.h"
#include "tests/benchmark/benchmark_run.h"
#include "tests/benchmark/markdown.h"
#include "tests/benchmark/peer_generators.h"
#include "tests/benchmark/tree_tables.h"
#include "trees/growth.h"

#include <algorithm>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <ostream>

namespace kokage {

namespace {

template <typename T>
std::uint64_t bytes_of(const std::vector<T>& values) {
    return values.size() * sizeof(T);
}

double seconds_of(const WorkReport& report, std::initializer_list<const char*> stages) {
    double sum = 0;
    for (const WorkReport::Stage& stage : report.stages)
        for (const char* name : stages)
            if (stage.name == name)
                sum += stage.cpu_seconds;
    return sum;
}

TreeRecord grow_once(const GrowthParameters& parameters) {
    WorkReport report;
    const Stopwatch watch;
    const Tree tree = grow(parameters, silent_progress(), &report);
    TreeRecord record;
    record.generator = "kokage";
    record.species = parameters.species;
    record.leaves = tree.leaves.size();
    record.cpu_seconds = watch.cpu();
    record.skeleton_and_leaves_cpu_seconds = seconds_of(report, {"skeleton", "leaves"});
    record.bark_cpu_seconds = seconds_of(report, {"bark"});
    for (const TreePart& part : tree.parts) {
        record.triangles += part.triangles.size();
        record.bytes +=
            bytes_of(part.positions) + bytes_of(part.normals) + bytes_of(part.uvs) + bytes_of(part.triangles);
    }
    return record;
}

/// Measures species one after the other, then other generators.
class TreesRun {
  public:
    TreesRun(const TreesBenchmarkOptions& options, Progress& progress, std::ostream& out)
        : options_(options), progress_(progress), out_(out), run_(options.output_folder, out) {}

    int execute(const std::vector<std::string>& species, const std::vector<int>& leaves) {
        for (const std::string& name : species) {
            for (const int count : leaves) {
                progress_.throw_if_stopped();
                take(measure_growth(name, count));
            }
            write();
        }
        if (options_.peers)
            for (const PeerGenerator& peer : peer_generators(std::uint64_t(leaves.back()), options_.quick)) {
                measure(peer);
                write();
            }
        run_.note(options_.plots ? plot_trees(records_, options_.output_folder) : "plots skipped: not asked for");
        write();
        out_ << "\n" << growth_figures(records_) << "\nwritten to " << options_.output_folder.string() << "\n";
        return run_.exit_status();
    }

  private:
    void measure(const PeerGenerator& peer) {
        if (!peer.why_not.empty())
            return run_.note("skipped: " + peer.name + ": " + peer.why_not);
        run_.attempt(peer.name, [&] { run_peer(peer, progress_, [this](const TreeRecord& record) { take(record); }); });
    }

    void take(const TreeRecord& record) {
        records_.push_back(record);
        out_ << "  " << std::left << std::setw(8) << record.generator << " " << std::setw(16) << record.species
             << std::right << std::setw(10) << count_text(record.leaves) << " leaves  " << std::setprecision(4)
             << std::setw(9) << record.cpu_seconds << " CPU-s  " << std::setw(6)
             << three_digits(double(record.bytes), 1e-6) << " MB"
             << "\n"
             << std::flush;
    }

    void write() const {
        nlohmann::json records = nlohmann::json::array();
        for (const TreeRecord& record : records_)
            records.push_back(to_json(record));
        run_.write("trees", "Benchmark of growing", records, growth_figures(records_), growth_table(records_));
    }

    const TreesBenchmarkOptions& options_;
    Progress& progress_;
    std::ostream& out_;
    BenchmarkRun run_;
    std::vector<TreeRecord> records_;
};

} // namespace

TreeRecord measure_growth(const std::string& species, int leaves) {
    constexpr std::size_t kRepeats = 5;
    constexpr double kLong = 1; // seconds
    GrowthParameters parameters = find_species(species).parameters;
    parameters.leaves = leaves;
    std::vector<TreeRecord> records = {grow_once(parameters)};
    while (records.size() < kRepeats && records.front().cpu_seconds < kLong)
        records.push_back(grow_once(parameters));
    std::sort(records.begin(), records.end(),
              [](const TreeRecord& a, const TreeRecord& b) { return a.cpu_seconds < b.cpu_seconds; });
    return records[records.size() / 2];
}

int run_trees_benchmark(const TreesBenchmarkOptions& options, Progress& progress, std::ostream& out) {
    std::vector<std::string> species;
    for (const Species& known : all_species())
        species.push_back(known.name);
    if (options.quick)
        return run_trees_benchmark({"oak", "spruce"}, {1000, 10000, 100000}, options, progress, out);
    return run_trees_benchmark(species, {1000, 10000, 100000, 1000000}, options, progress, out);
}

int run_trees_benchmark(const std::vector<std::string>& species, const std::vector<int>& leaves,
                        const TreesBenchmarkOptions& options, Progress& progress, std::ostream& out) {
    if (options.threads > 0)
        set_thread_count(options.threads);
    return TreesRun(options, progress, out).execute(species, leaves);
}

} // namespace kokage
