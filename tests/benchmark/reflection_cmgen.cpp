// cmgen, Filament's maker of prefiltered cube maps, and ours on the same work.
//
// cmgen turns a lat-long image into a cube of 256 first, mirrors it, and filters that by importance sampling; its faces
// show what is in direction (x, y, z) of ours at (-z, y, x) (libs/ibl/src/CubemapUtils.cpp: u = 1/2 + atan2(x, z) /
// 2pi, then x mirrored). Both are judged by brute force on the image itself at texel centres.
#include "common/environment/load_environment.h"
#include "common/scene/image_file.h"
#include "common/services/stopwatch.h"
#include "reflection/maps/cube_file.h"
#include "reflection/maps/spectral_baker.h"
#include "tests/benchmark/map_truth.h"
#include "tests/benchmark/reflection_environments.h"
#include "tests/benchmark/reflection_experiments.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <stdexcept>
#include <sys/resource.h>

namespace kokage {

namespace {

constexpr int kSize = 256, kLevels = 5, kRuns = 5;

/// User + system time of all child processes that have ended.
double children_cpu_seconds() {
    rusage usage{};
    getrusage(RUSAGE_CHILDREN, &usage);
    const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

std::string quoted(const std::filesystem::path& path) {
    std::string text = "'";
    for (const char c : path.string())
        text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return text + "'";
}

/// What both are judged by: a sample of the texels of each filtered level.
struct Truth {
    std::vector<TexelSample> samples; ///< of a level's own layout: texels count from 0 in each
    std::vector<std::vector<glm::vec3>> texels;
    double mean_radiance = 0;
};

Truth truth_of(const Environment& environment, std::size_t count) {
    Truth truth;
    for (int i = 1; i < kLevels; ++i) {
        const double roughness = filament_roughness(kLevels)[std::size_t(i)];
        const TexelLayout layout = filtered_layout(empty_cube({.size = kSize >> i, .parameters = {roughness}}));
        truth.samples.push_back(even_sample(layout, count));
        truth.texels.push_back(true_texels(truth.samples.back(), environment));
    }
    const Image& image = environment.remainder;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (int c = 0; c < 3; ++c)
                truth.mean_radiance +=
                    pixel_solid_angle(y, image.width, image.height) / (12 * kPiDouble) * double(image.at(x, y)[c]);
    return truth;
}

/// A record a level, then the whole's: `record` with the levels' mean error and their largest.
void judge_levels(const PrefilteredCube& cube, const Truth& truth, ReflectionRecord record,
                  const ExperimentContext& context) {
    double mean = 0, most = 0, mean_relative = 0, most_relative = 0;
    std::vector<ReflectionRecord> levels;
    for (std::size_t i = 0; i < truth.samples.size(); ++i) {
        ReflectionRecord level;
        level.experiment = record.experiment;
        level.environment = record.environment;
        level.method = record.method;
        level.lobe = record.lobe;
        level.size = cube.levels[i + 1].size;
        level.smoothness = cube.levels[i + 1].parameter;
        level.texels = double(cube.levels[i + 1].texels.size());
        level.note = "smoothness: glTF's roughness; judged at " + std::to_string(truth.texels[i].size()) + " texels";
        judge(values_at(truth.samples[i], cube.levels[i + 1].texels), truth.texels[i], level);
        level.mean_error_of_mean = *level.mean_error_255 / 255 / truth.mean_radiance;
        mean += *level.mean_error_of_mean / double(truth.samples.size());
        mean_relative += *level.mean_relative_error / double(truth.samples.size());
        most = std::max(most, *level.max_error_255);
        most_relative = std::max(most_relative, *level.max_relative_error);
        levels.push_back(level);
    }
    record.mean_error_of_mean = mean;
    record.mean_relative_error = mean_relative;
    record.max_error_255 = most;
    record.mean_error_255 = mean * truth.mean_radiance * 255;
    record.max_relative_error = most_relative;
    context.take(record);
    for (const ReflectionRecord& level : levels)
        context.take(level);
}

ReflectionRecord record_of(const std::string& environment, const std::string& method) {
    ReflectionRecord record;
    record.experiment = "cmgen";
    record.environment = environment;
    record.method = method;
    record.lobe = "ggx";
    record.size = kSize;
    record.texels = 6. * (128 * 128 + 64 * 64 + 32 * 32 + 16 * 16);
    return record;
}

/// cmgen's faces of one level, turned into our frame, at the texels of `sample` alone.
void read_cmgen_level(const std::filesystem::path& folder, int level, PrefilteredCube::Level& texels) {
    const std::array<const char*, 6> names = {"px", "nx", "py", "ny", "pz", "nz"};
    PrefilteredCube::Level theirs = texels;
    for (int face = 0; face < 6; ++face) {
        const Image image = load_image(folder / ("m" + std::to_string(level) + "_" + names[std::size_t(face)] + ".exr"),
                                       {.channels = 3});
        if (image.width != texels.size || image.height != texels.size)
            throw std::runtime_error("cmgen's level " + std::to_string(level) + " is " + std::to_string(image.width) +
                                     " texels wide, not " + std::to_string(texels.size));
        for (int y = 0; y < texels.size; ++y)
            for (int x = 0; x < texels.size; ++x)
                theirs.texels[cube_texel_index(face, x, y, texels.size)] = {image.at(x, y)[0], image.at(x, y)[1],
                                                                            image.at(x, y)[2]};
    }
    // A quarter turn about +Y leads texel centres onto texel centres.
    for (int face = 0; face < 6; ++face)
        for (int y = 0; y < texels.size; ++y)
            for (int x = 0; x < texels.size; ++x) {
                const glm::dvec3 d = cube_texel_direction(face, x, y, texels.size);
                texels.texels[cube_texel_index(face, x, y, texels.size)] =
                    theirs.texels[cube_texel_towards({-d.z, d.y, d.x}, texels.size)];
            }
}

void measure_theirs(const ExperimentContext& context, const std::filesystem::path& image, const Truth& truth) {
    const std::filesystem::path output = context.output_folder / "cmgen";
    const std::string command =
        "cmgen --quiet --format=exr --compression=RAW --ibl-samples=1024 --size=" + std::to_string(kSize) +
        " --ibl-ld=" + quoted(output) + " " + quoted(image) + " >/dev/null 2>&1";
    ReflectionRecord record = record_of(image.filename().string(), "cmgen");
    const double cpu = children_cpu_seconds(), wall = wall_seconds();
    if (std::system(command.c_str()) != 0)
        throw std::runtime_error("cmgen failed on " + image.string());
    record.cpu_seconds = children_cpu_seconds() - cpu;
    record.wall_seconds = wall_seconds() - wall;
    record.note = "1024 samples; the whole process, files of uncompressed half floats";
    PrefilteredCube cube = empty_cube({.size = kSize, .parameters = filament_roughness(kLevels)});
    for (int i = 0; i < kLevels; ++i)
        read_cmgen_level(output / image.stem(), i, cube.levels[std::size_t(i)]);
    std::filesystem::remove_all(output);
    judge_levels(cube, truth, record, context);
}

void measure_ours(const ExperimentContext& context, const std::filesystem::path& image, const Truth& truth,
                  const std::string& method, double tolerance) {
    const std::filesystem::path map = context.output_folder / "cmgen-ours.ktx2";
    const std::filesystem::path setup = context.output_folder / "cmgen-ours.setup";
    ReflectionRecord record = record_of(image.filename().string(), method);
    PrefilteredCube cube = empty_cube({.size = kSize, .parameters = filament_roughness(kLevels)});
    EnvironmentReport ignored;
    const EnvironmentLoading loading{.split = false};
    const Environment header = load_environment(image, ignored, loading); // the files are in the system's cache then
    WorkReport report;
    const SpectralSettings settings{.tolerance = tolerance, .stored_setup = setup};
    const auto make = [&] {
        return spectral_baker(filtered_layout(cube), header.remainder.width, header.remainder.height, settings, report,
                              context.progress);
    };
    Stopwatch watch;
    make(); // writes it down
    record.setup_cpu_seconds = watch.cpu();
    watch.restart();
    const std::unique_ptr<Baker> baker = make();
    const std::string stored =
        std::filesystem::exists(setup)
            ? "; beside the set-up, which takes " + std::to_string(watch.cpu()) + " CPU-s when it has been stored"
            : "; beside the set-up";
    std::vector<std::pair<double, double>> times;
    for (int run = 0; run < kRuns; ++run) {
        context.progress.throw_if_stopped();
        watch.restart();
        const Environment environment = load_environment(image, ignored, loading);
        bake_cube(cube, environment, baker.get(), report, context.progress);
        record.bytes = double(write_ktx2(map, cube, TexelFormat::half_rgb).bytes);
        times.emplace_back(watch.cpu(), watch.wall());
    }
    std::sort(times.begin(), times.end());
    record.cpu_seconds = times[kRuns / 2].first;
    record.wall_seconds = times[kRuns / 2].second;
    record.note = "tolerance " + std::to_string(tolerance) +
                  ", KTX 2 of half floats; reading, all five levels and writing" + stored;
    const PrefilteredCube written = read_ktx2(map).cube;
    std::error_code none;
    std::filesystem::remove(map, none);
    std::filesystem::remove(setup, none);
    judge_levels(written, truth, record, context);
}

} // namespace

void measure_cmgen(const ExperimentContext& context) {
    const ThreadsFor one_core(1);
    if (context.data_folder.empty()) {
        context.note("skipped: cube maps beside cmgen's, which need the HDR images");
        return;
    }
    const bool installed = std::system("cmgen --help >/dev/null 2>&1") == 0;
    if (!installed)
        context.note("skipped: cmgen is not installed (apt-get install libfilament-tools)");
    std::vector<std::string> files = real_hdr_files();
    files.insert(files.end(), {"forest_slope.hdr", "studio_small_03.hdr"}); // many lights; lights of many pixels
    if (context.quick)
        files.resize(1);
    for (const std::string& file : files) {
        context.progress.throw_if_stopped();
        std::filesystem::path image = context.data_folder / "env" / file;
        Image pixels = real_hdr(context.data_folder, file, 0);
        const bool converted = image.extension() != ".hdr"; // cmgen does not read every compression of EXR
        if (converted) {
            image = context.output_folder / (image.stem().string() + ".hdr");
            save_image(image, pixels);
            pixels = load_image(image, {.channels = 3});
        }
        const Truth truth = truth_of(unsplit(std::move(pixels), file), context.quick ? 100 : 500);
        if (installed)
            measure_theirs(context, image, truth);
        measure_ours(context, image, truth, "spectral", SpectralSettings{}.tolerance);
        measure_ours(context, image, truth, "spectral-coarse", 5e-3);
        if (converted)
            std::filesystem::remove(image);
    }
}

} // namespace kokage
