#include "tests/benchmark/relief_benchmark.h"
#include "common/services/parallel.h"
#include "tests/benchmark/benchmark_run.h"
#include "tests/benchmark/markdown.h"
#include "tests/benchmark/relief_experiments.h"
#include "tests/benchmark/relief_tables.h"

#include <algorithm>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <ostream>

namespace kokage {
namespace {

struct ReliefExperiment {
    const char* name;
    void (*measure)(const ReliefExperimentContext&);
};
constexpr ReliefExperiment kReliefExperiments[] = {
    {"views", measure_relief_views}, {"shadows", measure_relief_shadows}, {"occlusion", measure_relief_occlusion},
    {"paper", measure_relief_paper}, {"pictures", draw_reliefs},
};

void tell(std::ostream& out, const ReliefRecord& r) {
    out << "  " << std::left << std::setw(9) << r.experiment << " " << std::setw(17)
        << r.map + " " + std::to_string(r.size) << " " << std::setw(9) << r.view << " " << std::setw(16) << r.method
        << std::right;
    const auto figure = [&](std::optional<double> value, const char* unit) {
        if (value)
            out << "  " << three_digits(value) << unit;
    };
    figure(r.reads_mean, " reads");
    figure(r.ns_per_ray, " ns");
    if (r.wrong)
        out << "  " << *r.wrong << " wrong";
    if (r.ties && *r.ties > 0)
        out << "  " << *r.ties << " ties";
    figure(r.rms_error, " rms");
    out << "\n" << std::flush;
}

void write(const BenchmarkRun& run, const std::vector<ReliefRecord>& records) {
    nlohmann::json json = nlohmann::json::array();
    for (const ReliefRecord& record : records)
        json.push_back(to_json(record));
    run.write("relief", "Benchmark of relief", json, relief_figures(records), relief_tables(records));
}

} // namespace

std::vector<std::string> relief_experiment_names() {
    std::vector<std::string> names;
    for (const ReliefExperiment& experiment : kReliefExperiments)
        names.push_back(experiment.name);
    return names;
}

int run_relief_benchmark(const ReliefBenchmarkOptions& options, Progress& progress, std::ostream& out) {
    const std::vector<std::string>& asked = options.experiments;
    check_experiments(asked, relief_experiment_names());
    if (options.threads > 0)
        set_thread_count(options.threads);
    BenchmarkRun run(options.output_folder, out);
    std::vector<ReliefRecord> records;
    BenchmarkReliefs reliefs(options.data_folder);
    const ReliefExperimentContext context{.output_folder = options.output_folder,
                                          .quick = options.quick,
                                          .reliefs = reliefs,
                                          .progress = progress,
                                          .take =
                                              [&](const ReliefRecord& record) {
                                                  records.push_back(record);
                                                  tell(out, record);
                                              },
                                          .note = [&](const std::string& line) { run.note(line); }};
    if (options.data_folder.empty())
        run.note("skipped: bark_willow_disp.png; give --data or set KOKAGE_DATA");
    for (const ReliefExperiment& experiment : kReliefExperiments) {
        if (!asked.empty() && std::find(asked.begin(), asked.end(), experiment.name) == asked.end())
            continue;
        progress.throw_if_stopped();
        run.attempt(experiment.name, [&] { experiment.measure(context); });
        write(run, records);
    }
    run.note(options.plots ? plot_relief(records, options.output_folder) : "plots skipped: not asked for");
    write(run, records);
    out << "\n" << relief_figures(records) << "\nwritten to " << options.output_folder.string() << "\n";
    return run.exit_status();
}

} // namespace kokage
