#include "common/services/parallel.h"
#include "common/services/stopwatch.h"
#include "tests/benchmark/reflection_environments.h"
#include "tests/benchmark/reflection_experiments.h"

#include <algorithm>

namespace kokage {

std::vector<Environment> clamped_surroundings(const ExperimentContext& context) {
    std::vector<Environment> surroundings = {unsplit(colour_pattern(), "pattern")};
    if (!context.data_folder.empty())
        surroundings.push_back(unsplit(photograph(context.data_folder), "photograph"));
    return surroundings;
}

std::vector<glm::vec3> timed_bake(Baker& baker, const Environment& surroundings, std::size_t texels, Progress& progress,
                                  ReflectionRecord& record) {
    constexpr std::size_t kRepeats = 5;
    constexpr double kLong = 1; // seconds
    std::vector<double> cpu, wall;
    std::vector<glm::vec3> filtered(texels);
    while (cpu.empty() || (cpu.size() < kRepeats && cpu.front() < kLong)) {
        WorkReport report;
        const Stopwatch watch;
        baker.bake(surroundings, filtered, report, progress);
        cpu.push_back(watch.cpu());
        wall.push_back(watch.wall());
    }
    std::sort(cpu.begin(), cpu.end());
    std::sort(wall.begin(), wall.end());
    record.cpu_seconds = cpu[cpu.size() / 2];
    record.wall_seconds = wall[wall.size() / 2];
    record.texels = double(texels);
    return filtered;
}

ThreadsFor::ThreadsFor(int threads) : before_(thread_count()) {
    set_thread_count(threads);
}

ThreadsFor::~ThreadsFor() {
    set_thread_count(before_);
}

} // namespace kokage
