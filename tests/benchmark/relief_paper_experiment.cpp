// [D]'s own experiments: its base method against its depth maps, in reads and in time.
#include "tests/benchmark/relief_experiments.h"
#include "tests/benchmark/relief_judge.h"
#include "tests/benchmark/relief_maps.h"
#include "tests/benchmark/relief_views.h"

namespace kokage {
namespace {

struct PaperCase {
    ReliefView view;
    std::vector<int> sizes; ///< of the depth maps
};

std::vector<PaperCase> paper_cases(bool quick) {
    const int side = quick ? 128 : 512;
    const std::vector<int> sizes{32, 64, 128};
    return {{sphere_view(side, 8), sizes}, {plane_view(0, side, 7), sizes}, {plane_view(45, side, 8), sizes}};
}

} // namespace

void measure_relief_paper(const ReliefExperimentContext& context) {
    const std::vector<PaperCase> cases = paper_cases(context.quick);
    for (const BenchmarkMap& map : context.reliefs.maps()) {
        if (map.field.width > 256)
            continue; // the paper's maps are small
        std::vector<std::vector<TrueReliefHit>> truths;
        for (const PaperCase& one : cases)
            truths.push_back(true_hits(map.field, one.view.rays, context.progress));
        const auto measure = [&](const BenchmarkMethod& method) {
            context.progress.throw_if_stopped();
            ReliefRecord record = record_of("paper", map, method.name);
            const ReliefTracer& tracer = context.reliefs.tracer(map, method, record);
            for (std::size_t k = 0; k < cases.size(); ++k) {
                record.view = cases[k].view.name;
                const std::vector<ReliefHit> hits = timed_trace(tracer, cases[k].view.rays, record);
                judge(map.field, cases[k].view.rays, hits, truths[k], kBenchReliefDepth, record);
                context.take(record);
            }
        };
        for (const BenchmarkMethod& method : benchmark_methods())
            if (method.name.starts_with("linear-64"))
                measure(method);
        for (const int size : cases.front().sizes)
            measure(paper_method(size));
    }
}

} // namespace kokage
