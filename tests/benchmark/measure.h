#pragma once
// One method at one effort on one scene: time, memory and error.
#include "common/services/progress.h"
#include "tests/benchmark/benchmark_plan.h"
#include "tests/benchmark/foliage_record.h"
#include "tests/benchmark/foliage_scenes.h"
#include "tests/benchmark/reference.h"

#include <optional>

namespace kokage {

/// What is known about a scene's truth.
struct SceneTruth {
    std::vector<glm::vec3> sides;
    double noise = 0;
};

/// The furnace's truth (radiance 1 on all sides), or a reference's.
SceneTruth furnace_truth(std::size_t leaves);
SceneTruth truth_of(const Reference& reference);

/// Shades the scene and measures CPU time of everything after loading (make_transport and the first solve), then
/// relights it with `relit`. Work of less than a CPU-second is repeated up to five times and the median taken, since
/// clocks and caches of a busy machine are noisy; the error is the first run's. `relit_truth` may be null.
FoliageRecord measure(const BenchScene& scene, const PlannedEffort& effort, const SceneTruth& truth,
                      const Environment& relit, const SceneTruth* relit_truth, Progress& progress);

} // namespace kokage
