#include "common/services/stopwatch.h"
#include "reflection/maps/table_baker.h"
#include "reflection/maps/voxel_cube.h"
#include "tests/benchmark/map_truth.h"
#include "tests/benchmark/reflection_experiments.h"

#include <cstdio>

namespace kokage {

namespace {

constexpr double kThresholds[] = {0.001, 0.005, 0.01, 0.05, 0.1};
constexpr std::pair<TableWeights, const char*> kKinds[] = {{TableWeights::paper, "table-paper"},
                                                           {TableWeights::renormalised, "table-renormalised"},
                                                           {TableWeights::matched, "table"}};

struct JudgedSurroundings {
    Environment environment;
    std::vector<glm::vec3> truth, truth_by_dome;
};

/// In words, for the record: against the paper's own truth, and what its table would take.
std::string table_note(const ReflectionRecord& by_dome, const WeightTable& table) {
    char text[200];
    std::snprintf(text, sizeof text,
                  "against the finest dome's sum, the paper's truth: mean %.3f/255; one row a voxel would take %.1f MB",
                  *by_dome.mean_error_255, double(table.unshared_bytes()) / 1e6);
    return text;
}

void measure_brute_force(const ExperimentContext& context, const VoxelCube& cube, const TexelSample& sample,
                         std::vector<JudgedSurroundings>& judged) {
    for (JudgedSurroundings& one : judged) {
        ReflectionRecord record;
        record.experiment = "tables-2-3";
        record.environment = one.environment.description;
        record.method = "brute-force";
        record.lobe = "phong";
        record.size = cube.scale().cube_size();
        const Stopwatch watch;
        one.truth = true_texels(sample, one.environment);
        record.cpu_seconds = watch.cpu() * double(cube.layout().size()) / double(sample.texels.size());
        record.texels = double(cube.layout().size());
        record.note = "extrapolated from " + std::to_string(sample.texels.size()) +
                      " voxels; pixels beyond 1e-17 of the peak are left out";
        one.truth_by_dome = true_texels_by_dome(sample, one.environment.remainder);
        context.take(record);
    }
}

} // namespace

void measure_tables(const ExperimentContext& context) {
    const ThreadsFor one_core(1);
    const int size = 128;
    const VoxelCube cube(LobeKind::phong, RoughnessScale::solved(size));
    const TexelSample sample = even_sample(cube.layout(), context.quick ? 1000 : 4000);
    std::vector<JudgedSurroundings> judged;
    for (Environment& environment : clamped_surroundings(context))
        judged.push_back({std::move(environment), {}, {}});
    measure_brute_force(context, cube, sample, judged);
    for (const auto& [weights, name] : kKinds)
        for (const double threshold : kThresholds) {
            context.progress.throw_if_stopped();
            const Stopwatch watch;
            const WeightTable table(cube.layout(), {.threshold = threshold, .weights = weights}, context.progress);
            const double setup = watch.cpu();
            for (const JudgedSurroundings& one : judged) {
                ReflectionRecord record, by_dome;
                record.experiment = "tables-2-3";
                record.environment = one.environment.description;
                record.method = name;
                record.lobe = "phong";
                record.size = size;
                record.threshold = threshold;
                record.setup_cpu_seconds = setup;
                record.bytes = double(table.bytes());
                const Stopwatch filtering;
                std::vector<glm::vec3> filtered(cube.layout().size());
                table.filter(light_on_domes(one.environment.remainder), filtered, context.progress);
                record.cpu_seconds = filtering.cpu();
                record.wall_seconds = filtering.wall();
                record.texels = double(filtered.size());
                const std::vector<glm::vec3> values = values_at(sample, filtered);
                judge(values, one.truth, record);
                judge(values, one.truth_by_dome, by_dome);
                record.note = table_note(by_dome, table);
                context.take(record);
            }
        }
}

} // namespace kokage
