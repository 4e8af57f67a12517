#include "tests/benchmark/foliage_benchmark.h"
#include "common/services/parallel.h"
#include "common/services/stopwatch.h"
#include "tests/benchmark/benchmark_plan.h"
#include "tests/benchmark/benchmark_run.h"
#include "tests/benchmark/effort_plot.h"
#include "tests/benchmark/environments.h"
#include "tests/benchmark/find_reference.h"
#include "tests/benchmark/foliage_tables.h"
#include "tests/benchmark/measure.h"

#include <algorithm>
#include <cstdlib>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <ostream>

namespace kokage {

namespace {

std::filesystem::path data_folder(const FoliageBenchmarkOptions& options) {
    if (!options.data_folder.empty())
        return options.data_folder;
    const char* folder = std::getenv("KOKAGE_DATA");
    return folder ? folder : "";
}

ReferenceOptions reference_options(const FoliageBenchmarkOptions& options) {
    ReferenceOptions reference;
    reference.stored_folder = options.references_folder.empty() ? std::filesystem::path(KOKAGE_BENCHMARK_REFERENCES)
                                                                : options.references_folder;
    reference.cache_folder = options.cache_folder.empty() ? options.output_folder / "references" : options.cache_folder;
    reference.paths_per_side = options.reference_paths;
    reference.paths_per_chunk = std::clamp<std::uint64_t>(options.reference_paths / 2, 1, 256);
    return reference;
}

/// Measures planned scenes one after the other.
class FoliageRun {
  public:
    FoliageRun(const FoliageBenchmarkOptions& options, Progress& progress, std::ostream& out)
        : options_(options), progress_(progress), out_(out), run_(options.output_folder, out),
          scenes_(data_folder(options)) {}

    int execute(const std::vector<PlannedScene>& plan) {
        for (std::size_t i = 0; i < plan.size(); ++i) {
            out_ << "[" << i + 1 << "/" << plan.size() << "] " << to_string(plan[i].name) << "\n" << std::flush;
            if (const std::string reason = scenes_.why_not(plan[i].name); !reason.empty())
                run_.note("skipped: " + to_string(plan[i].name) + ": " + reason);
            else
                run_scene(plan[i]);
            write();
        }
        run_.note(options_.plots ? plot_efforts(records_, options_.output_folder) : "plots skipped: not asked for");
        write();
        out_ << "\n"
             << summary_table(summarise(records_)) << "\nwritten to " << options_.output_folder.string() << " in "
             << std::setprecision(0) << watch_.wall() << " s\n";
        return run_.exit_status();
    }

  private:
    void run_scene(const PlannedScene& planned) {
        const BenchScene scene = scenes_.make(planned.name);
        const SceneTruth truth = truth_for(scene);
        // Where there is a reference of the relit scene, relighting is judged by it.
        std::optional<SceneTruth> relit_truth;
        Environment relit = with_another_sky(*scene.environment);
        if (planned.name.light == BenchLight::sky_sun && planned.name.leaves == 30000 &&
            planned.name.material == BenchMaterial::realistic) {
            const BenchScene other = scenes_.make({BenchLight::sky_sun_relit, 30000, BenchMaterial::realistic});
            relit = *other.environment;
            relit_truth = truth_for(other);
        }
        for (const PlannedEffort& effort : planned.efforts) {
            progress_.throw_if_stopped();
            run_.attempt(std::string(method_name(effort.method)) + " on " + to_string(planned.name), [&] {
                records_.push_back(
                    measure(scene, effort, truth, relit, relit_truth ? &*relit_truth : nullptr, progress_));
                tell(records_.back());
            });
        }
    }

    SceneTruth truth_for(const BenchScene& scene) {
        if (scene.name.light == BenchLight::furnace)
            return furnace_truth(scene.patches.leaf_count);
        const ReferenceOptions reference = reference_options(options_);
        if (std::optional<Reference> found = find_reference(scene, reference))
            return truth_of(*found);
        out_ << "  no stored reference of " << to_string(scene.name) << " as it is now: tracing one ("
             << reference.paths_per_side << " paths a leaf side)\n"
             << std::flush;
        return truth_of(find_or_make_reference(scene, reference, progress_));
    }

    void tell(const FoliageRecord& record) {
        out_ << "  " << std::left << std::setw(12) << method_name(record.method) << std::right << std::setw(8)
             << std::setprecision(record.effort < 1 ? 2 : 0) << record.effort << " " << std::left << std::setw(12)
             << record.effort_kind << std::right << std::setprecision(3) << std::setw(9) << record.cpu_seconds
             << " CPU-s   MRE " << std::setprecision(2) << std::setw(6) << 100 * record.accuracy.mre << " %   bias "
             << std::showpos << 100 * record.accuracy.bias << std::noshowpos << " %"
             << (record.judged() ? "" : "   (not judged: below 5 x the reference's noise)") << "\n"
             << std::flush;
    }

    void write() const {
        nlohmann::json records = nlohmann::json::array();
        for (const FoliageRecord& record : records_)
            records.push_back(to_json(record));
        run_.write("foliage", "Benchmark of foliage shading", records, summary_table(summarise(records_)),
                   record_table(records_));
    }

    const FoliageBenchmarkOptions& options_;
    Progress& progress_;
    std::ostream& out_;
    Stopwatch watch_;
    BenchmarkRun run_;
    BenchScenes scenes_;
    std::vector<FoliageRecord> records_;
};

} // namespace

int run_foliage_benchmark(const FoliageBenchmarkOptions& options, Progress& progress, std::ostream& out) {
    return run_foliage_benchmark(benchmark_plan(options.quick), options, progress, out);
}

int run_foliage_benchmark(const std::vector<PlannedScene>& plan, const FoliageBenchmarkOptions& options,
                          Progress& progress, std::ostream& out) {
    if (options.threads > 0)
        set_thread_count(options.threads);
    return FoliageRun(options, progress, out).execute(plan);
}

} // namespace kokage
