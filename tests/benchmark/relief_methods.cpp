#include "common/services/stopwatch.h"
#include "reflection/relief/cone_tracer.h"
#include "reflection/relief/depth_map_tracer.h"
#include "reflection/relief/exact_tracer.h"
#include "reflection/relief/height_field_image.h"
#include "reflection/relief/linear_tracer.h"
#include "tests/benchmark/relief_experiments.h"
#include "tests/benchmark/relief_maps.h"

namespace kokage {
namespace {

DepthMapSettings depth_map_settings(int texels) {
    DepthMapSettings settings;
    settings.size = texels;
    settings.scale = {glm::vec2(1.f), kBenchReliefDepth};
    return settings;
}

} // namespace

BenchmarkReliefs::BenchmarkReliefs(const std::filesystem::path& data_folder) {
    for (const auto& [map, size] : {std::pair(ReliefMap::bark, 256), std::pair(ReliefMap::bark, 1024),
                                    std::pair(ReliefMap::spikes, 256), std::pair(ReliefMap::low, 256)})
        maps_.push_back({std::string(relief_map_name(map)), make_relief_map(map, size, size)});
    if (data_folder.empty())
        return;
    HeightImageReport report;
    const std::filesystem::path willow = data_folder / "textures/bark_willow_disp.png";
    maps_.push_back({willow.stem(), load_relief(willow, {glm::vec2(1.f), kBenchReliefDepth}, {}, report).field});
}

const ReliefTracer& BenchmarkReliefs::tracer(const BenchmarkMap& map, const BenchmarkMethod& method,
                                             ReliefRecord& record) {
    Made& made = made_[{&map, method.name}];
    if (!made.tracer) {
        const Stopwatch watch;
        made.tracer = method.make(map.field);
        made.cpu_seconds = watch.cpu();
    }
    record.preprocess_cpu_seconds = made.cpu_seconds;
    record.bytes = double(made.tracer->bytes());
    return *made.tracer;
}

ReliefRecord record_of(const std::string& experiment, const BenchmarkMap& map, const std::string& method) {
    ReliefRecord record;
    record.experiment = experiment;
    record.map = map.name;
    record.size = map.field.width;
    record.method = method;
    return record;
}

BenchmarkMethod paper_method(int texels) {
    return {"depth-maps-" + std::to_string(texels), [texels](const HeightField& field) {
                const std::unique_ptr<ExactTracer> source = make_exact_tracer(field);
                return make_depth_map_tracer(field, trace_depth_maps(depth_map_settings(texels), *source));
            }};
}

std::vector<BenchmarkMethod> benchmark_methods() {
    return {
        {"exact", [](const HeightField& field) { return make_exact_tracer(field); }},
        {"linear-64", [](const HeightField& field) { return make_linear_tracer(field, {.steps = 64}); }},
        {"linear-128", [](const HeightField& field) { return make_linear_tracer(field, {.steps = 128}); }},
        paper_method(64),
        {"conservative-64",
         [](const HeightField& field) {
             return make_conservative_tracer(field, bound_depth_maps(field, depth_map_settings(64)),
                                             make_exact_tracer(field));
         }},
        {"cone", [](const HeightField& field) { return make_cone_tracer(field); }},
    };
}

} // namespace kokage
