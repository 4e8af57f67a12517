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
    int every_row, every_column; ///< of the truth: one of all pixels would take hours
    std::uint64_t truth_samples;
    std::vector<FastEffort> fast;
    std::vector<int> traced; ///< samples a pixel
};

RenderPlan plan_of(bool quick) {
    constexpr double kError = 0.15;
    if (quick)
        return {480, 360, 8, 7, 8192, {{kError, 4}, {kError, 16}, {kError, 32}, {kError, 64}}, {16, 64, 256, 1024}};
    return {640,
            480,
            10,
            10,
            32768,
            {{kError, 4}, {kError, 16}, {kError, 32}, {kError, 64}, {0.05, 64}},
            {16, 64, 256, 1024, 4096}};
}

/// Path tracing's time grows in proportion to its samples, once it has begun: two pictures of few tell.
constexpr int kFewSamples = 2, kMoreSamples = 8;
constexpr int kSplitSamples = 32; ///< of the fast pictures whose errors are split

/// Measures one scene.
class SceneMeasurement {
  public:
    SceneMeasurement(const SceneDescription& description, const RenderPlan& plan, const TruthOptions& truth,
                     Progress& progress)
        : plan_(plan), progress_(progress), scene_(assemble_scene(description, progress)), name_(description.name),
          picture_(description.picture), truth_(find_truth(scene_, judged_pixels(), name_, truth, progress)) {}

    const PictureTruth& truth() const { return truth_; }

    PictureRecord fast(const FastEffort& effort, Image* radiance) {
        const Stopwatch watch;
        const RenderedScene rendered = draw(effort, picture_.seed);
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
        if (effort.samples == kSplitSamples)
            split_errors(rendered.picture.radiance, draw(effort, picture_.seed + 1).picture.radiance, truth_, record);
        if (radiance)
            *radiance = rendered.picture.radiance;
        return record;
    }

    PictureRecord traced(int samples) {
        if (!(cpu_per_sample_ > 0))
            time_tracing();
        PictureRecord record = record_of("path-traced", samples);
        record.effort = std::to_string(samples) + " samples";
        record.cpu_seconds = record.render_cpu_seconds = cpu_before_ + cpu_per_sample_ * samples;
        record.note = "time from those of " + std::to_string(kFewSamples) + " and " + std::to_string(kMoreSamples) +
                      " samples; error of the judged pixels, traced with all samples";
        judge(trace(judged_pixels(), samples), truth_, record);
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

    RenderedScene draw(const FastEffort& effort, std::uint64_t seed) {
        RenderOptions options;
        options.picture = picture_;
        options.picture.samples = effort.samples;
        options.picture.seed = seed;
        options.error = effort.error;
        return render_scene(scene_, options, progress_);
    }

    Image trace(PictureOptions picture, int samples) {
        RenderOptions options;
        options.method = RenderMethod::path_traced;
        picture.samples = samples;
        options.picture = picture;
        return render_scene(scene_, options, progress_).picture.radiance;
    }

    PictureOptions judged_pixels() const {
        PictureOptions rows = picture_;
        rows.every_row = plan_.every_row;
        rows.every_column = plan_.every_column;
        return rows;
    }

    void time_tracing() {
        const auto cpu_of = [&](int samples) {
            const Stopwatch watch;
            trace(picture_, samples);
            return watch.cpu();
        };
        const double few = cpu_of(kFewSamples), more = cpu_of(kMoreSamples);
        cpu_per_sample_ = (more - few) / (kMoreSamples - kFewSamples);
        cpu_before_ = std::max(0.0, few - kFewSamples * cpu_per_sample_);
    }

    const RenderPlan& plan_;
    Progress& progress_;
    const AssembledScene scene_;
    const std::string name_;
    const PictureOptions picture_;
    const PictureTruth truth_;
    double cpu_before_ = 0, cpu_per_sample_ = 0;
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
        compare_times(records);
        nlohmann::json json = nlohmann::json::array();
        for (const PictureRecord& record : records)
            json.push_back(to_json(record));
        run.write("render", "Benchmark of the renderer", json, render_figures(records), render_tables(records));
    };
    if (options.data_folder.empty())
        run.note("a turned pot stands in for the teapot; give --data or set KOKAGE_DATA");
    run.note("errors are judged on one of " + std::to_string(plan.every_row * plan.every_column) + " pixels of " +
             std::to_string(plan.width) + " x " + std::to_string(plan.height) +
             ", where the truth was traced; times are of whole pictures");
    const TruthOptions truth = {
        options.references_folder.empty() ? std::filesystem::path(KOKAGE_BENCHMARK_REFERENCES)
                                          : options.references_folder,
        options.cache_folder.empty() ? options.output_folder / "references" : options.cache_folder, plan.truth_samples};
    for (const SceneDescription& description :
         render_scenes(plan.width, plan.height, options.data_folder, options.output_folder)) {
        run.attempt(description.name, [&] {
            SceneMeasurement measurement(description, plan, truth, progress);
            out << description.name << ": truth of " << measurement.truth().samples << " paths on each of "
                << measurement.truth().pixels.size() << " pixels, "
                << (measurement.truth().is_stored ? "stored" : "traced now") << "\n"
                << std::flush;
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
