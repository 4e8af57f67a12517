#include "common/scene/image_file.h"
#include "common/services/parallel.h"
#include "common/services/stopwatch.h"
#include "reflection/maps/bake_sequence.h"
#include "reflection/maps/make_baker.h"
#include "reflection/maps/voxel_cube.h"
#include "tests/benchmark/markdown.h"
#include "tests/benchmark/reflection_environments.h"
#include "tests/benchmark/reflection_experiments.h"

#include <algorithm>
#include <filesystem>

namespace kokage {

namespace {

/// Made anew, and removed with all in it.
struct BenchmarkFolder {
    explicit BenchmarkFolder(std::filesystem::path name) : path(std::move(name)) {
        std::filesystem::remove_all(path);
        std::filesystem::create_directories(path);
    }
    ~BenchmarkFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
    }
    BenchmarkFolder(const BenchmarkFolder&) = delete;
    BenchmarkFolder& operator=(const BenchmarkFolder&) = delete;
    std::filesystem::path path;
};

/// The image turned about +Y, a little more each frame: a camera that pans.
Image turned(const Image& image, int columns) {
    Image result(image.width, image.height, image.channels);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            std::copy_n(image.at((x + columns) % image.width, y), image.channels, result.at(x, y));
    return result;
}

constexpr int kSize = 64;

/// What `kokage bake` does with a pan of so many .hdr frames: from file to file.
ReflectionRecord from_file_to_file(const ExperimentContext& context, const Environment& first, int frames) {
    const BenchmarkFolder folder(context.output_folder / "video-frames");
    for (int frame = 1; frame <= frames; ++frame)
        save_image(folder.path / (std::to_string(frame) + ".hdr"), turned(first.remainder, 7 * frame));
    MapSettings cube;
    cube.container = MapContainer::voxel_cube;
    cube.size = kSize;
    cube.compression = ExrCompression::none;
    const std::unique_ptr<BakedMap> map = make_map(cube);
    SequenceSettings settings;
    settings.output = (folder.path / "maps" / "%d.exr").string();
    WorkReport report;
    const SequenceResult result =
        bake_sequence(image_sequence((folder.path / "%d.hdr").string()), settings, *map, report, context.progress);
    const double cpu = result.reading_cpu_seconds + result.baking_cpu_seconds + result.writing_cpu_seconds;
    ReflectionRecord record;
    record.experiment = "video";
    record.environment = first.description;
    record.method = "spectral-files";
    record.lobe = "phong";
    record.size = kSize;
    record.setup_cpu_seconds = result.setup_cpu_seconds;
    record.cpu_seconds = cpu / frames;
    record.wall_seconds = (result.wall_seconds - result.setup_wall_seconds) / frames;
    record.frames_per_second = result.frames_per_second();
    record.texels = double(map->layout().size());
    record.bytes = double(map->bytes());
    record.note = std::to_string(frames) + " frames on " + std::to_string(thread_count()) +
                  " threads, from .hdr to uncompressed .exr of halves; CPU ms a frame: reading " +
                  three_digits(result.reading_cpu_seconds / frames, 1e3) + ", baking " +
                  three_digits(result.baking_cpu_seconds / frames, 1e3) + ", writing " +
                  three_digits(result.writing_cpu_seconds / frames, 1e3);
    return record;
}

} // namespace

void measure_video(const ExperimentContext& context) {
    constexpr int kThreads = 2;
    const int frames = context.quick ? 30 : 120;
    const ThreadsFor two_cores(kThreads);
    const Environment first = clamped_surroundings(context).back();
    context.take(from_file_to_file(context, first, frames));
    VoxelCube cube(LobeKind::phong, RoughnessScale::solved(kSize));
    for (const auto& [name, settings] : {std::pair("spectral", BakerSettings{}),
                                         std::pair("spectral, tolerance 0.0004", BakerSettings{.tolerance = 4e-4}),
                                         std::pair("table", BakerSettings{.method = BakeMethod::table})}) {
        context.progress.throw_if_stopped();
        ReflectionRecord record;
        record.experiment = "video";
        record.environment = first.description;
        record.method = name;
        record.lobe = "phong";
        record.size = kSize;
        WorkReport report;
        const Stopwatch setting_up;
        const std::unique_ptr<Baker> baker = make_baker(cube.layout(), first.remainder.width, first.remainder.height,
                                                        settings, report, context.progress);
        record.setup_cpu_seconds = setting_up.cpu();
        std::vector<glm::vec3> filtered(cube.layout().size());
        double cpu = 0, wall = 0;
        for (int frame = 0; frame < frames; ++frame) {
            const Environment environment = unsplit(turned(first.remainder, 7 * frame), first.description);
            WorkReport of_frame;
            const Stopwatch watch;
            baker->bake(environment, filtered, of_frame);
            cube.set_texels(filtered);
            cpu += watch.cpu();
            wall += watch.wall();
        }
        record.cpu_seconds = cpu / frames;
        record.wall_seconds = wall / frames;
        record.frames_per_second = frames / wall;
        record.texels = double(cube.layout().size());
        record.bytes = 12.0 * double(cube.voxels().size());
        record.note = std::to_string(frames) + " frames on " + std::to_string(thread_count()) +
                      " threads, from image in memory to voxels in memory";
        context.take(record);
    }
}

} // namespace kokage
