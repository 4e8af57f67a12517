#include "common/services/parallel.h"
#include "common/services/stopwatch.h"
#include "tests/benchmark/relief_experiments.h"
#include "tests/benchmark/relief_judge.h"
#include "tests/benchmark/relief_maps.h"
#include "tests/benchmark/relief_views.h"

namespace kokage {

void measure_relief_views(const ReliefExperimentContext& context) {
    const std::vector<ReliefView> views = benchmark_views(context.quick ? 160 : 640);
    for (const BenchmarkMap& map : context.reliefs.maps()) {
        std::vector<std::vector<TrueReliefHit>> truths;
        for (const ReliefView& view : views)
            truths.push_back(true_hits(map.field, view.rays, context.progress));
        for (const BenchmarkMethod& method : benchmark_methods()) {
            context.progress.throw_if_stopped();
            ReliefRecord record = record_of("views", map, method.name);
            const ReliefTracer& tracer = context.reliefs.tracer(map, method, record);
            for (std::size_t k = 0; k < views.size(); ++k) {
                record.view = views[k].name;
                const std::vector<ReliefHit> hits = timed_trace(tracer, views[k].rays, record);
                judge(map.field, views[k].rays, hits, truths[k], kBenchReliefDepth, record);
                context.take(record);
            }
        }
    }
}

} // namespace kokage
