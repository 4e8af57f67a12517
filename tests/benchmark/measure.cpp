#include "tests/benchmark/measure.h"
#include "common/services/stopwatch.h"

#include <algorithm>
#include <cmath>

namespace kokage {

namespace {

constexpr double kRepeatBelowSeconds = 1.0;
constexpr std::size_t kMostRepeats = 5;
// Relighting by path tracing is path tracing once more: above this it is not done only to show that it takes as long.
constexpr double kPathTracedRelightSeconds = 5.0;

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

double maximum_error(const std::vector<glm::vec3>& sides, const std::vector<glm::vec3>& truth) {
    glm::dvec3 mean(0.0);
    for (const glm::vec3& side : truth)
        mean += glm::dvec3(side) / double(truth.size());
    double largest = 0;
    for (std::size_t i = 0; i < sides.size(); ++i)
        for (glm::length_t c = 0; c < 3; ++c) {
            const double scale = std::max(double(truth[i][c]), 0.05 * mean[c]);
            largest = std::max(largest, scale > 0 ? std::abs(double(sides[i][c]) - truth[i][c]) / scale : 0.0);
        }
    return largest;
}

std::optional<double> count_of(const WorkReport& report, const std::string& name) {
    for (const WorkReport::Count& count : report.counts)
        if (count.name == name)
            return double(count.value);
    return std::nullopt;
}

} // namespace

SceneTruth furnace_truth(std::size_t leaves) {
    return {std::vector<glm::vec3>(2 * leaves, glm::vec3(1.f)), 0.0};
}
SceneTruth truth_of(const Reference& reference) {
    return {reference.sides, reference.noise};
}

FoliageRecord measure(const BenchScene& scene, const PlannedEffort& effort, const SceneTruth& truth,
                      const Environment& relit, const SceneTruth* relit_truth, Progress& progress) {
    FoliageRecord record;
    record.scene = bench_light_name(scene.name.light);
    record.leaves = scene.name.leaves;
    record.material = bench_material_name(scene.name.material);
    record.method = effort.method;
    record.effort_kind = effort.kind;
    record.effort = effort.value;
    record.reference_noise = truth.noise;

    const ShadingOptions options = shading_options(effort);
    std::vector<double> cpu, wall, relight;
    double spent = 0;
    while (cpu.empty() || (cpu.size() < kMostRepeats && spent < kRepeatBelowSeconds)) {
        const Stopwatch watch;
        const auto transport = make_transport(scene.patches, *scene.tree, options, progress);
        const Solution solution = transport->solve(*scene.environment, progress);
        cpu.push_back(watch.cpu());
        wall.push_back(watch.wall());
        spent += cpu.back();
        const bool first = cpu.size() == 1;
        if (first) {
            const auto sides = leaf_side_radiance(scene.patches, solution.radiance);
            record.accuracy = accuracy(sides, truth.sides, scene.leaf_areas);
            record.maximum_error = maximum_error(sides, truth.sides);
            record.estimated_error = solution.estimated_error;
            record.paths = count_of(solution.report, "paths");
            record.bytes_per_leaf = double(transport->bytes()) / std::max<std::uint32_t>(1, scene.patches.leaf_count);
        }
        if (effort.method == Method::path_traced && cpu.back() > kPathTracedRelightSeconds)
            continue;
        const Stopwatch relight_watch;
        const Solution again = transport->solve(relit, progress);
        relight.push_back(relight_watch.cpu());
        if (first && relit_truth)
            record.relight_mre =
                accuracy(leaf_side_radiance(scene.patches, again.radiance), relit_truth->sides, scene.leaf_areas).mre;
    }
    record.cpu_seconds = median(cpu);
    record.wall_seconds = median(wall);
    if (!relight.empty())
        record.relight_cpu_seconds = median(relight);
    return record;
}

} // namespace kokage
