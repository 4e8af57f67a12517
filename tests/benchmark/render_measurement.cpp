#include "tests/benchmark/render_measurement.h"
#include "common/scene/image_file.h"
#include "common/services/stopwatch.h"
#include "reflection/compare_images.h"
#include "tests/benchmark/markdown.h"

#include <algorithm>

namespace kokage {
namespace {

/// Path tracing's time grows in proportion to its samples, once it has begun: two pictures of few tell.
constexpr int kFewSamples = 2, kMoreSamples = 8;
constexpr int kSplitSamples = 32;  ///< of the fast pictures whose errors are split
constexpr int kLayerSamples = 512; ///< of the paths that tell which light is wrong

constexpr int kMapWidth = 160, kMapFastSamples = 64, kMapScale = 3;

/// Pictures of one size in a row, each pixel `scale` x `scale` large.
Image beside_one_another(const std::vector<Image>& images, int scale) {
    const int width = images[0].width * scale, height = images[0].height * scale;
    Image all(width * int(images.size()), height, 3);
    for (std::size_t k = 0; k < images.size(); ++k)
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                std::copy_n(images[k].at(x / scale, y / scale), 3, all.at(int(k) * width + x, y));
    return all;
}

Image mean_of(const Image& one, const Image& two) {
    Image mean = one;
    for (std::size_t i = 0; i < mean.pixels.size(); ++i)
        mean.pixels[i] = 0.5f * (one.pixels[i] + two.pixels[i]);
    return mean;
}

} // namespace

RenderMeasurement::RenderMeasurement(const SceneDescription& description, const RenderPlan& plan,
                                     const TruthOptions& truth, Progress& progress)
    : plan_(plan), progress_(progress), scene_(assemble_scene(description, progress)), name_(description.name),
      picture_(description.picture),
      truth_(find_truth(scene_, judged_pixels(plan_, picture_), name_, truth, progress)) {}

PictureRecord RenderMeasurement::fast(const FastEffort& effort, Image& radiance) const {
    const Stopwatch watch;
    RenderedScene rendered = draw(effort, picture_);
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
    radiance = std::move(rendered.picture.radiance);
    judge(radiance, truth_, record);
    if (effort.samples == kSplitSamples)
        split(effort, radiance, record);
    return record;
}

PictureRecord RenderMeasurement::traced(int samples) {
    if (!(cpu_per_sample_ > 0))
        time_tracing();
    PictureRecord record = record_of("path-traced", samples);
    record.effort = std::to_string(samples) + " samples";
    record.cpu_seconds = record.render_cpu_seconds = cpu_before_ + cpu_per_sample_ * samples;
    record.note = "time from those of " + std::to_string(kFewSamples) + " and " + std::to_string(kMoreSamples) +
                  " samples; error of the judged pixels, traced with all samples";
    judge(trace(judged_pixels(plan_, picture_), samples).radiance, truth_, record);
    return record;
}

std::string RenderMeasurement::save_error_map(const std::filesystem::path& file) const {
    PictureOptions small = picture_;
    small.width = kMapWidth;
    small.height = std::max(1, kMapWidth * picture_.height / picture_.width);
    const Image drawn = draw({RenderOptions().error, kMapFastSamples}, small).picture.radiance;
    const Image one = trace(small, plan_.map_samples / 2).radiance;
    small.seed += 1000;
    const Image two = trace(small, plan_.map_samples / 2).radiance, truth = mean_of(one, two);
    const ImageComparison errors = compare_images(drawn, truth);
    const float stops = automatic_exposure_stops(truth);
    save_image(file, beside_one_another({tone_map(drawn, stops), tone_map(truth, stops), errors.map}, kMapScale),
               {.png_encoding = PngEncoding::as_is});
    double mean = 0;
    for (const float value : truth.pixels)
        mean += double(value) / double(truth.pixels.size());
    const double percent = mean > 0 ? 100 / mean : 0;
    return file.filename().string() + ": fast (" + std::to_string(kMapFastSamples) + " samples), path-traced (" +
           std::to_string(plan_.map_samples) + "), and the largest difference of a pixel's channels, in % of the " +
           "picture's mean: " + error_legend_text(double(errors.map_scale), percent, " %") + "; mean difference " +
           three_digits(errors.all.mean, percent) + " %, of which path tracing's own noise is " +
           three_digits(compare_images(one, two).all.mean / 2, percent) + " %";
}

PictureRecord RenderMeasurement::record_of(const std::string& method, int samples) const {
    PictureRecord record;
    record.scene = name_;
    record.method = method;
    record.width = picture_.width;
    record.height = picture_.height;
    record.samples = samples;
    return record;
}

RenderedScene RenderMeasurement::draw(const FastEffort& effort, PictureOptions picture) const {
    RenderOptions options;
    picture.samples = effort.samples;
    options.picture = picture;
    options.error = effort.error;
    return render_scene(scene_, options, progress_);
}

Picture RenderMeasurement::trace(PictureOptions picture, int samples) const {
    RenderOptions options;
    options.method = RenderMethod::path_traced;
    picture.samples = samples;
    options.picture = picture;
    return render_scene(scene_, options, progress_).picture;
}

void RenderMeasurement::split(const FastEffort& effort, const Image& radiance, PictureRecord& record) const {
    PictureOptions layered = picture_;
    layered.layers = true;
    ++layered.seed;
    const Picture again = draw(effort, layered).picture;
    split_errors(radiance, again.radiance, truth_, record);
    split_bias(again, trace(judged_pixels(plan_, layered), kLayerSamples), truth_, record);
}

void RenderMeasurement::time_tracing() {
    const auto cpu_of = [&](int samples) {
        const Stopwatch watch;
        trace(picture_, samples);
        return watch.cpu();
    };
    const double few = cpu_of(kFewSamples), more = cpu_of(kMoreSamples);
    cpu_per_sample_ = (more - few) / (kMoreSamples - kFewSamples);
    cpu_before_ = std::max(0.0, few - kFewSamples * cpu_per_sample_);
}

} // namespace kokage
