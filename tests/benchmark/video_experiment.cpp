#include "common/services/parallel.h"
#include "common/services/stopwatch.h"
#include "reflection/maps/make_baker.h"
#include "reflection/maps/voxel_cube.h"
#include "tests/benchmark/reflection_environments.h"
#include "tests/benchmark/reflection_experiments.h"

#include <algorithm>

namespace kokage {

namespace {

/// The image turned about +Y, a little more each frame: a camera that pans.
Image turned(const Image& image, int columns) {
    Image result(image.width, image.height, image.channels);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            std::copy_n(image.at((x + columns) % image.width, y), image.channels, result.at(x, y));
    return result;
}

} // namespace

void measure_video(const ExperimentContext& context) {
    constexpr int kSize = 64, kThreads = 2;
    const int frames = context.quick ? 30 : 120;
    const ThreadsFor two_cores(kThreads);
    const Environment first = clamped_surroundings(context).back();
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
