#pragma once
// What `kokage bench reflection` measures, a function an experiment. Each gives its records as they come, and says in
// notes what it left out and why.
#include "common/environment/environment.h"
#include "common/services/progress.h"
#include "reflection/maps/baker.h"
#include "tests/benchmark/reflection_record.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace kokage {

struct ExperimentContext {
    std::filesystem::path data_folder; ///< empty: synthetic surroundings alone
    std::filesystem::path output_folder;
    bool quick = false;
    Progress& progress;
    std::function<void(const ReflectionRecord&)> take;
    std::function<void(const std::string&)> note;
};

/// The paper's tables 2 and 3: records "tables-2-3", methods "table-paper" (as its figures imply), "table-renormalised"
/// and "table" (ours), at its five thresholds; and "brute-force", whose time is extrapolated from a sample of voxels.
void measure_tables(const ExperimentContext& context);
/// "spectral": cubes of 128 and 64, images of at most 1; time on one core, errors over all shells.
void measure_spectral(const ExperimentContext& context);
/// "hdr": relative errors in a cube of 128, lights among the pixels.
void measure_hdr(const ExperimentContext& context);
/// "containers": shells and the cube, looked up between texels.
void measure_containers(const ExperimentContext& context);
/// "teapot": the paper's table 4 (reflection_teapot.h).
void measure_teapot(const ExperimentContext& context);
/// "video": frames a second of a cube of 64: from file to file ("spectral-files"), and of all methods by themselves.
void measure_video(const ExperimentContext& context);
/// "skips": what baking only smoothness 0.3 to 0.6 saves.
void measure_skips(const ExperimentContext& context);

/// "cmgen": a GGX cube map of 256 with five levels from HDR files of 1024 x 512, by cmgen (where it is installed) and
/// by ours, reading and writing counted.
void measure_cmgen(const ExperimentContext& context);

/// Surroundings of at most 1 that errors of 255 are told in: the pattern, and the photograph where there is data.
std::vector<Environment> clamped_surroundings(const ExperimentContext& context);

/// Bakes, once more where it is quick (the median of five is told), into cpu_seconds, wall_seconds, texels.
std::vector<glm::vec3> timed_bake(Baker& baker, const Environment& surroundings, std::size_t texels, Progress& progress,
                                  ReflectionRecord& record);

/// While one lives, work is done by so many threads.
class ThreadsFor {
  public:
    explicit ThreadsFor(int threads);
    ~ThreadsFor();
    ThreadsFor(const ThreadsFor&) = delete;
    ThreadsFor& operator=(const ThreadsFor&) = delete;

  private:
    int before_;
};

} // namespace kokage
