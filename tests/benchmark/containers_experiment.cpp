#include "common/directions/sphere_sets.h"
#include "common/services/random.h"
#include "common/services/stopwatch.h"
#include "reflection/maps/make_baker.h"
#include "reflection/maps/shell_map.h"
#include "reflection/maps/voxel_cube.h"
#include "tests/benchmark/map_truth.h"
#include "tests/benchmark/reflection_experiments.h"

#include <algorithm>

namespace kokage {

namespace {

constexpr int kSize = 128;
constexpr double kLeastSmoothness = 0.01; // below it the cube has nothing but its centre

/// Places between texels: directions evenly over the sphere, smoothness evenly from rough to smooth.
struct Lookups {
    TexelSample sample;
    std::vector<float> smoothness;
};

Lookups lookups(const RoughnessScale& scale, int count) {
    Lookups result;
    result.sample.layout.kind = LobeKind::phong;
    Random random(5);
    for (const glm::dvec3& direction : fibonacci_sphere(count).directions) {
        const double smoothness = kLeastSmoothness + (1 - kLeastSmoothness) * random.uniform_double();
        result.sample.layout.directions.push_back(glm::vec3(direction));
        result.sample.layout.parameters.push_back(float(scale.exponent(smoothness)));
        result.smoothness.push_back(float(smoothness));
    }
    return result;
}

ReflectionRecord record_of(const Environment& environment, const std::string& method, std::size_t count) {
    ReflectionRecord record;
    record.experiment = "containers";
    record.environment = environment.description;
    record.method = method;
    record.lobe = "phong";
    record.size = kSize;
    record.note = std::to_string(count) + " lookups between texels, ";
    return record;
}

/// With what baking takes, in `record`.
std::vector<glm::vec3> texels_of(const TexelLayout& layout, const Environment& environment,
                                 const ExperimentContext& context, ReflectionRecord& record) {
    WorkReport report;
    const Stopwatch watch;
    const std::unique_ptr<Baker> baker =
        make_baker(layout, environment.remainder.width, environment.remainder.height, {}, report, context.progress);
    record.setup_cpu_seconds = watch.cpu();
    return timed_bake(*baker, environment, layout.size(), context.progress, record);
}

void measure_shells(const ExperimentContext& context, const Environment& environment, const Lookups& at,
                    const std::vector<glm::vec3>& truth, const ShellSettings& settings) {
    ShellMap shells(settings);
    ReflectionRecord record = record_of(environment, "shells", truth.size());
    shells.set_texels(texels_of(shells.layout(), environment, context, record));
    record.bytes = double(shells.bytes());
    record.note += std::string(texel_format_name(settings.format)) + ", " + std::to_string(shells.shells().size()) +
                   " shells, the smoothest of 6 x " + std::to_string(shells.shells().back().resolution) + "^2";
    std::vector<glm::vec3> values(truth.size());
    shells.lookup(at.sample.layout.directions, at.sample.layout.parameters, values);
    judge(values, truth, record);
    context.take(record);
}

void measure_cube(const ExperimentContext& context, const Environment& environment, const Lookups& at,
                  const std::vector<glm::vec3>& truth) {
    VoxelCube cube(LobeKind::phong, RoughnessScale::solved(kSize));
    ReflectionRecord record = record_of(environment, "cube", truth.size());
    cube.set_texels(texels_of(cube.layout(), environment, context, record));
    record.bytes = double(texel_bytes(TexelFormat::half_rgb) * cube.voxels().size());
    record.note += "bytes as half, kept in memory as float";
    std::vector<glm::vec3> values(truth.size());
    cube.lookup(at.sample.layout.directions, at.smoothness, values);
    judge(values, truth, record);
    context.take(record);
}

} // namespace

void measure_containers(const ExperimentContext& context) {
    const ThreadsFor one_core(1);
    const Lookups at = lookups(RoughnessScale::solved(kSize), context.quick ? 4000 : 20000);
    for (const Environment& environment : clamped_surroundings(context)) {
        const std::vector<glm::vec3> truth = true_texels(at.sample, environment);
        for (const TexelFormat format : {TexelFormat::half_rgb, TexelFormat::shared_exponent}) {
            context.progress.throw_if_stopped();
            measure_shells(context, environment, at, truth, {.format = format});
        }
        measure_cube(context, environment, at, truth);
    }
}

void measure_skips(const ExperimentContext& context) {
    const ThreadsFor one_core(1);
    const RoughnessScale scale = RoughnessScale::solved(kSize);
    const Environment environment = clamped_surroundings(context).back();
    for (const auto& [low, high] : {std::pair(kLeastSmoothness, 1.0), std::pair(0.3, 0.6)}) {
        context.progress.throw_if_stopped();
        const ShellMap shells({.least_parameter = scale.exponent(low), .most_parameter = scale.exponent(high)});
        ReflectionRecord record = record_of(environment, "shells", 0);
        record.experiment = "skips";
        record.note = "smoothness " + std::to_string(low).substr(0, 4) + " to " + std::to_string(high).substr(0, 4);
        WorkReport report;
        const Stopwatch watch;
        const std::unique_ptr<Baker> baker = make_baker(shells.layout(), environment.remainder.width,
                                                        environment.remainder.height, {}, report, context.progress);
        record.setup_cpu_seconds = watch.cpu();
        timed_bake(*baker, environment, shells.layout().size(), context.progress, record);
        record.bytes = double(shells.bytes());
        context.take(record);
    }
}

} // namespace kokage
