#include "tests/benchmark/reflection_benchmark.h"
#include "common/services/parallel.h"
#include "tests/benchmark/benchmark_run.h"
#include "tests/benchmark/markdown.h"
#include "tests/benchmark/reflection_experiments.h"
#include "tests/benchmark/reflection_tables.h"

#include <algorithm>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <ostream>

namespace kokage {

namespace {

struct ReflectionExperiment {
    const char* name;
    void (*measure)(const ExperimentContext&);
};
constexpr ReflectionExperiment kReflectionExperiments[] = {
    {"tables", measure_tables},         {"spectral", measure_spectral}, {"hdr", measure_hdr},
    {"containers", measure_containers}, {"teapot", measure_teapot},     {"video", measure_video},
    {"skips", measure_skips},           {"cmgen", measure_cmgen},
};

class ReflectionRun {
  public:
    ReflectionRun(const ReflectionBenchmarkOptions& options, std::ostream& out)
        : options_(options), out_(out), run_(options.output_folder, out) {}

    int execute(Progress& progress) {
        ExperimentContext context{.data_folder = options_.data_folder,
                                  .output_folder = options_.output_folder,
                                  .quick = options_.quick,
                                  .progress = progress,
                                  .take = [this](const ReflectionRecord& record) { take(record); },
                                  .note = [this](const std::string& line) { run_.note(line); }};
        if (options_.data_folder.empty())
            run_.note("skipped: the photograph, the real HDR images and all that needs them; give --data or set "
                      "KOKAGE_DATA");
        const std::vector<std::string>& asked = options_.experiments;
        for (const ReflectionExperiment& experiment : kReflectionExperiments) {
            if (!asked.empty() && std::find(asked.begin(), asked.end(), experiment.name) == asked.end())
                continue;
            progress.throw_if_stopped();
            run_.attempt(experiment.name, [&] { experiment.measure(context); });
            write();
        }
        run_.note(options_.plots ? plot_reflection(records_, options_.output_folder) : "plots skipped: not asked for");
        write();
        out_ << "\n" << reflection_figures(records_) << "\nwritten to " << options_.output_folder.string() << "\n";
        return run_.exit_status();
    }

  private:
    void take(const ReflectionRecord& r) {
        records_.push_back(r);
        out_ << "  " << std::left << std::setw(11) << r.experiment << " " << std::setw(19) << r.method << " "
             << std::setw(22) << r.environment << std::right;
        const auto figure = [&](const char* before, std::optional<double> value, const char* after) {
            if (value)
                out_ << "  " << before << three_digits(value) << after;
        };
        figure("th ", r.threshold, "");
        figure("set-up ", r.setup_cpu_seconds, " s");
        figure("", r.cpu_seconds, " CPU-s");
        figure("", r.frames_per_second, " frames/s");
        figure("mean ", r.mean_error_255, "/255");
        figure("max ", r.max_error_255, "/255");
        out_ << "\n" << std::flush;
    }

    void write() const {
        nlohmann::json records = nlohmann::json::array();
        for (const ReflectionRecord& record : records_)
            records.push_back(to_json(record));
        run_.write("reflection", "Benchmark of reflection maps", records, reflection_figures(records_),
                   reflection_tables(records_));
    }

    const ReflectionBenchmarkOptions& options_;
    std::ostream& out_;
    BenchmarkRun run_;
    std::vector<ReflectionRecord> records_;
};

} // namespace

std::vector<std::string> reflection_experiment_names() {
    std::vector<std::string> names;
    for (const ReflectionExperiment& experiment : kReflectionExperiments)
        names.push_back(experiment.name);
    return names;
}

int run_reflection_benchmark(const ReflectionBenchmarkOptions& options, Progress& progress, std::ostream& out) {
    check_experiments(options.experiments, reflection_experiment_names());
    if (options.threads > 0)
        set_thread_count(options.threads);
    return ReflectionRun(options, out).execute(progress);
}

} // namespace kokage
