#include "common/services/stopwatch.h"
#include "reflection/maps/make_baker.h"
#include "reflection/maps/voxel_cube.h"
#include "tests/benchmark/map_truth.h"
#include "tests/benchmark/reflection_environments.h"
#include "tests/benchmark/reflection_experiments.h"

#include <algorithm>
#include <cstdio>

namespace kokage {

namespace {

ReflectionRecord record_of(const char* experiment, const Environment& environment, BakeMethod method, int size) {
    ReflectionRecord record;
    record.experiment = experiment;
    record.environment = environment.description;
    record.method = bake_method_name(method);
    record.lobe = "phong";
    record.size = size;
    return record;
}

std::string judged_note(const TexelSample& sample, std::span<const glm::vec3> filtered) {
    float least = filtered.front().x;
    for (const glm::vec3& value : filtered)
        least = std::min({least, value.x, value.y, value.z});
    char text[120];
    std::snprintf(text, sizeof text, "judged at %zu voxels of all shells; least value %.3g", sample.texels.size(),
                  double(least));
    return text;
}

/// Bakes a cube by a method, with set-up and times on one core, and judges it.
void measure_cube(const ExperimentContext& context, const char* experiment, const Environment& environment,
                  const VoxelCube& cube, const TexelSample& sample, const std::vector<glm::vec3>& truth,
                  const BakerSettings& settings) {
    context.progress.throw_if_stopped();
    ReflectionRecord record = record_of(experiment, environment, settings.method, cube.scale().cube_size());
    if (settings.tolerance != BakerSettings{}.tolerance) {
        char text[32];
        std::snprintf(text, sizeof text, ", tolerance %g", settings.tolerance);
        record.method += text;
    }
    WorkReport report;
    const Stopwatch watch;
    const std::unique_ptr<Baker> baker = make_baker(cube.layout(), environment.remainder.width,
                                                    environment.remainder.height, settings, report, context.progress);
    record.setup_cpu_seconds = watch.cpu();
    const std::vector<glm::vec3> filtered =
        timed_bake(*baker, environment, cube.layout().size(), context.progress, record);
    judge(values_at(sample, filtered), truth, record);
    record.bytes = 12.0 * double(cube.voxels().size());
    record.note = judged_note(sample, filtered);
    context.take(record);
}

std::vector<Environment> hdr_surroundings(const ExperimentContext& context) {
    std::vector<Environment> surroundings = {unsplit(lone_sun(), "sun-1e6")};
    if (context.data_folder.empty())
        return surroundings;
    for (const std::string& file : real_hdr_files())
        surroundings.push_back(unsplit(real_hdr(context.data_folder, file, 512), file));
    return surroundings;
}

} // namespace

void measure_spectral(const ExperimentContext& context) {
    const ThreadsFor one_core(1);
    for (const int size : {128, 64}) {
        const VoxelCube cube(LobeKind::phong, RoughnessScale::solved(size));
        const TexelSample sample = sample_of_all_shells(cube.layout(), context.quick ? 1000 : 8000);
        for (const Environment& environment : clamped_surroundings(context)) {
            const std::vector<glm::vec3> truth = true_texels(sample, environment);
            for (const BakerSettings& settings :
                 {BakerSettings{}, BakerSettings{.tolerance = 4e-4}, BakerSettings{.tolerance = 2e-3},
                  BakerSettings{.method = BakeMethod::table}})
                measure_cube(context, "spectral", environment, cube, sample, truth, settings);
        }
    }
}

void measure_hdr(const ExperimentContext& context) {
    const ThreadsFor one_core(1);
    const VoxelCube cube(LobeKind::phong, RoughnessScale::solved(128));
    const TexelSample sample = sample_of_all_shells(cube.layout(), context.quick ? 1000 : 8000);
    for (const Environment& environment : hdr_surroundings(context)) {
        const std::vector<glm::vec3> truth = true_texels(sample, environment);
        for (const BakeMethod method : {BakeMethod::spectral, BakeMethod::table})
            measure_cube(context, "hdr", environment, cube, sample, truth, {.method = method});
    }
}

} // namespace kokage
