#include "tests/benchmark/render_benchmark.h"
#include "common/scene/image_file.h"
#include "common/services/parallel.h"
#include "common/services/stopwatch.h"
#include "tests/benchmark/benchmark_run.h"
#include "tests/benchmark/markdown.h"
#include "tests/benchmark/render_judge.h"
#include "tests/benchmark/render_scenes.h"
#include "tests/benchmark/render_tables.h"

#include <nlohmann/json.hpp>
#include <ostream>

namespace kokage {
namespace {

struct FastEffort {
    double error;
    int samples;
};

struct RenderPlan {
    int width, height;
    int truth_samples, every_row; ///< a truth of all rows would take hours
    std::vector<FastEffort> fast;
    std::vector<int> traced; ///< samples a pixel
};

RenderPlan plan_of(bool quick) {
    if (quick)
        return {240, 180, 4096, 12, {{0.1, 2}, {0.05, 4}, {0.05, 16}, {0.05, 32}}, {4, 16, 64, 256, 1024}};
    return {480,
            360,
            8192,
            12,
            {{0.1, 2}, {0.1, 4}, {0.05, 8}, {0.05, 16}, {0.03, 32}, {0.03, 64}},
            {4, 16, 64, 256, 1024}};
}

constexpr int kTimedSamples = 4; ///< of path tracing: its time grows in proportion

/// Measures one scene.
class SceneMeasurement {
  public:
    SceneMeasurement(const SceneDescription& description, const RenderPlan& plan, Progress& progress)
        : plan_(plan), progress_(progress), scene_(assemble_scene(description, progress)), name_(description.name),
          picture_(description.picture),
          truth_(find_truth(scene_, picture_, plan.truth_samples, plan.every_row, progress)) {}

    const RenderTruth& truth() const { return truth_; }

    PictureRecord fast(const FastEffort& effort, Image* radiance) {
        RenderOptions options;
        options.picture = picture_;
        options.picture.samples = effort.samples;
        options.error = effort.error;
        const Stopwatch watch;
        const RenderedScene rendered = render_scene(scene_, options, progress_);
        PictureRecord record = record_of("fast", effort.samples);
        record.cpu_seconds = watch.cpu();
        record.error = effort.error;
        record.effort = "error " + three_digits(effort.error) + ", " + std::to_string(effort.samples) + " samples";
        for (const WorkReport::Stage& stage : rendered.report.stages)
            for (const auto& [stage_name, field] : {std::pair("transport", &PictureRecord::transport_cpu_seconds),
                                                    std::pair("solve", &PictureRecord::solve_cpu_seconds),
                                                    std::pair("render", &PictureRecord::render_cpu_seconds)})
                if (stage.name == stage_name)
                    record.*field = stage.cpu_seconds;
        judge(rendered.picture.radiance, truth_, record);
        if (radiance)
            *radiance = rendered.picture.radiance;
        return record;
    }

    PictureRecord traced(int samples) {
        if (!(traced_cpu_ > 0))
            time_tracing();
        PictureOptions rows = picture_;
        rows.every_row = plan_.every_row;
        PictureRecord record = record_of("path-traced", samples);
        record.effort = std::to_string(samples) + " samples";
        record.cpu_seconds = record.render_cpu_seconds = traced_cpu_ * samples / kTimedSamples;
        record.note = "time of " + std::to_string(kTimedSamples) + " samples in proportion; errors of judged rows";
        judge(trace(rows, samples), truth_, record);
        return record;
    }

  private:
    PictureRecord record_of(const std::string& method, int samples) const {
        PictureRecord record;
        record.scene = name_;
        record.method = method;
        record.width = picture_.width;
        record.height = picture_.height;
        record.samples = samples;
        return record;
    }

    Image trace(PictureOptions picture, int samples) {
        RenderOptions options;
        options.method = RenderMethod::path_traced;
        picture.samples = samples;
        options.picture = picture;
        return render_scene(scene_, options, progress_).picture.radiance;
    }

    void time_tracing() {
        const Stopwatch watch;
        trace(picture_, kTimedSamples);
        traced_cpu_ = watch.cpu();
    }

    const RenderPlan& plan_;
    Progress& progress_;
    const AssembledScene scene_;
    const std::string name_;
    const PictureOptions picture_;
    const RenderTruth truth_;
    double traced_cpu_ = 0;
};

void tell(std::ostream& out, const PictureRecord& r) {
    out << "  " << r.scene << ", " << r.method << ", " << r.effort << ": " << three_digits(r.cpu_seconds)
        << " CPU-s, error " << three_digits(r.mean_error, 100) << " %, p95 " << three_digits(r.p95_error, 100)
        << " %, bias " << three_digits(r.bias, 100) << " %, noise of the truth " << three_digits(r.reference_noise, 100)
        << " %;";
    for (const auto& [kind, error] : r.mean_error_of)
        out << " " << kind << " " << three_digits(error, 100);
    out << "\n" << std::flush;
}

} // namespace

int run_render_benchmark(const RenderBenchmarkOptions& options, Progress& progress, std::ostream& out) {
    if (options.threads > 0)
        set_thread_count(options.threads);
    BenchmarkRun run(options.output_folder, out);
    const RenderPlan plan = plan_of(options.quick);
    std::vector<PictureRecord> records;
    const auto take = [&](const PictureRecord& record) {
        records.push_back(record);
        tell(out, record);
    };
    const auto write = [&] {
        nlohmann::json json = nlohmann::json::array();
        for (const PictureRecord& record : records)
            json.push_back(to_json(record));
        run.write("render", "Benchmark of the renderer", json, render_figures(records), render_tables(records));
    };
    if (options.data_folder.empty())
        run.note("a turned pot stands in for the teapot; give --data or set KOKAGE_DATA");
    run.note("the truth was traced on every " + std::to_string(plan.every_row) + "th row of " +
             std::to_string(plan.width) + " x " + std::to_string(plan.height) +
             " pixels, and there errors are judged; times are of whole pictures");
    for (const SceneDescription& description :
         render_scenes(plan.width, plan.height, options.data_folder, options.output_folder)) {
        run.attempt(description.name, [&] {
            SceneMeasurement measurement(description, plan, progress);
            Image radiance;
            for (const int samples : plan.traced)
                take(measurement.traced(samples));
            for (const FastEffort& effort : plan.fast)
                take(measurement.fast(effort, &radiance));
            save_image(options.output_folder / ("render-" + description.name + ".png"),
                       tone_map(radiance, std::nullopt), {.png_encoding = PngEncoding::as_is});
        });
        write();
    }
    run.note(options.plots ? plot_render(records, options.output_folder) : "plots skipped: not asked for");
    write();
    out << "\n" << render_figures(records) << "\nwritten to " << options.output_folder.string() << "\n";
    return run.exit_status();
}

} // namespace kokage
