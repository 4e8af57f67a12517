#include "tests/benchmark/render_benchmark.h"
#include "common/scene/image_file.h"
#include "common/services/parallel.h"
#include "tests/benchmark/benchmark_run.h"
#include "tests/benchmark/markdown.h"
#include "tests/benchmark/render_measurement.h"
#include "tests/benchmark/render_scenes.h"
#include "tests/benchmark/render_skips.h"
#include "tests/benchmark/render_tables.h"
#include "tests/benchmark/render_worst.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <ostream>

namespace kokage {
namespace {

void tell(std::ostream& out, const PictureRecord& r) {
    out << "  " << r.scene << ", " << r.method << ", " << r.effort << ": " << three_digits(r.cpu_seconds)
        << " CPU-s, error " << three_digits(r.mean_error, 100) << " %, p95 " << three_digits(r.p95_error, 100)
        << " %, bias " << three_digits(r.bias, 100) << " %, noise of the truth " << three_digits(r.reference_noise, 100)
        << " %;";
    for (const auto& [kind, error] : r.mean_error_of)
        out << " " << kind << " " << three_digits(error, 100);
    out << "\n" << std::flush;
}

void tell_skip(std::ostream& out, const PictureRecord& r) {
    out << "  " << r.method << ", " << r.scene << ", " << r.effort << ": " << three_digits(r.cpu_seconds) << " CPU-s";
    if (r.change_by_skip)
        out << ", changes the picture by " << three_digits(r.change_by_skip, 100) << " %; " << r.note;
    out << "\n" << std::flush;
}

TruthOptions truth_options(const RenderBenchmarkOptions& options, const RenderPlan& plan) {
    return {options.references_folder.empty() ? std::filesystem::path(KOKAGE_BENCHMARK_REFERENCES)
                                              : options.references_folder,
            options.cache_folder.empty() ? options.output_folder / "references" : options.cache_folder,
            plan.truth_samples};
}

class RenderBenchmark {
  public:
    RenderBenchmark(const RenderBenchmarkOptions& options, Progress& progress, std::ostream& out)
        : options_(options), plan_(render_plan(options.quick)), progress_(progress), out_(out),
          run_(options.output_folder, out) {}

    int execute() {
        if (options_.data_folder.empty())
            run_.note("a turned pot stands in for the teapot; give --data or set KOKAGE_DATA");
        if (wanted("pictures"))
            measure_pictures();
        if (wanted("skips")) {
            run_.attempt("skips", [&] {
                measure_skips(plan_, options_.data_folder, options_.output_folder, progress_,
                              [&](const PictureRecord& record) {
                                  skips_.push_back(record);
                                  tell_skip(out_, record);
                              });
            });
            write();
        }
        out_ << "\n"
             << (records_.empty() ? skip_table(skips_) : render_figures(records_)) << "\nwritten to "
             << options_.output_folder.string() << "\n";
        return run_.exit_status();
    }

  private:
    bool wanted(const std::string& experiment) const {
        const auto& asked = options_.experiments;
        return asked.empty() || std::find(asked.begin(), asked.end(), experiment) != asked.end();
    }

    void measure_pictures() {
        run_.note("errors are judged on one of " + std::to_string(plan_.every_row * plan_.every_column) +
                  " pixels of " + std::to_string(plan_.width) + " x " + std::to_string(plan_.height) +
                  ", where the truth was traced; times are of whole pictures");
        for (const SceneDescription& description :
             render_scenes(plan_.width, plan_.height, options_.data_folder, options_.output_folder)) {
            run_.attempt(description.name, [&] { measure(description); });
            write();
        }
        run_.note(options_.plots ? plot_render(records_, options_.output_folder) : "plots skipped: not asked for");
        write();
    }

    void measure(const SceneDescription& description) {
        RenderMeasurement measurement(description, plan_, truth_options(options_, plan_), progress_);
        const PictureTruth& truth = measurement.truth();
        run_.note(description.name + ": truth of " + std::to_string(truth.samples) + " paths on each of " +
                  std::to_string(truth.pixels.size()) + " pixels, " + (truth.is_stored ? "stored" : "traced now"));
        for (const int samples : plan_.traced)
            take(measurement.traced(samples));
        Image radiance;
        for (const FastEffort& effort : plan_.fast)
            take(measurement.fast(effort, radiance));
        save_image(options_.output_folder / ("render-" + description.name + ".png"), tone_map(radiance, std::nullopt),
                   {.png_encoding = PngEncoding::as_is});
        run_.note(measurement.save_error_map(options_.output_folder / ("render-" + description.name + "-error.png")));
    }

    void take(const PictureRecord& record) {
        records_.push_back(record);
        tell(out_, record);
    }

    void write() {
        compare_times(records_);
        nlohmann::json json = nlohmann::json::array();
        for (const auto* records : {&records_, &skips_})
            for (const PictureRecord& record : *records)
                json.push_back(to_json(record));
        std::string tables = render_tables(records_);
        if (const std::string worst = worst_text(records_); !worst.empty())
            tables += "\n## Where pictures are worst\n\n" + worst;
        if (!skips_.empty())
            tables += "\n## What is left out\n\n" + skip_table(skips_);
        run_.write("render", "Benchmark of the renderer", json, render_figures(records_), tables);
    }

    const RenderBenchmarkOptions& options_;
    const RenderPlan plan_;
    Progress& progress_;
    std::ostream& out_;
    BenchmarkRun run_;
    std::vector<PictureRecord> records_, skips_;
};

} // namespace

std::vector<std::string> render_experiment_names() {
    return {"pictures", "skips"};
}

int run_render_benchmark(const RenderBenchmarkOptions& options, Progress& progress, std::ostream& out) {
    check_experiments(options.experiments, render_experiment_names());
    if (options.threads > 0)
        set_thread_count(options.threads);
    return RenderBenchmark(options, progress, out).execute();
}

} // namespace kokage
