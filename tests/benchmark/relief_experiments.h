#pragma once
// What `kokage bench relief` measures, a function an experiment. Each gives its records as they come, and says in notes
// what it left out and why.
#include "common/services/progress.h"
#include "reflection/relief/relief_tracer.h"
#include "tests/benchmark/relief_record.h"

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace kokage {

struct BenchmarkMap {
    std::string name;
    HeightField field;
};

/// A method with its settings, by the name that records give it.
struct BenchmarkMethod {
    std::string name;
    std::function<std::unique_ptr<ReliefTracer>(const HeightField&)> make;
};
/// exact, linear-64 and linear-128 (with 6 bisections), depth-maps-64, conservative-64, cone.
std::vector<BenchmarkMethod> benchmark_methods();
/// The paper's maps, shrunk to `texels` along an edge.
BenchmarkMethod paper_method(int texels);

/// What rays are sent to: made once, for all experiments.
class BenchmarkReliefs {
  public:
    /// bark at 256² and 1024², spikes, low; bark_willow_disp.png where there is a data folder.
    explicit BenchmarkReliefs(const std::filesystem::path& data_folder);
    const std::vector<BenchmarkMap>& maps() const { return maps_; }
    /// Made at its first use; what that cost goes into the record's preprocess_cpu_seconds and bytes.
    const ReliefTracer& tracer(const BenchmarkMap& map, const BenchmarkMethod& method, ReliefRecord& record);

  private:
    struct Made {
        std::unique_ptr<ReliefTracer> tracer;
        double cpu_seconds;
    };
    std::vector<BenchmarkMap> maps_;
    std::map<std::pair<const BenchmarkMap*, std::string>, Made> made_;
};

struct ReliefExperimentContext {
    std::filesystem::path output_folder;
    bool quick = false;
    BenchmarkReliefs& reliefs;
    Progress& progress;
    std::function<void(const ReliefRecord&)> take;
    std::function<void(const std::string&)> note;
};

ReliefRecord record_of(const std::string& experiment, const BenchmarkMap& map, const std::string& method);

/// "views": every method on every map: a plane from 10° to 85° and a tiled sphere.
void measure_relief_views(const ReliefExperimentContext& context);
/// "paper": [D]'s own experiments: a sphere with maps of 64², planes with maps of 32², other sizes.
void measure_relief_paper(const ReliefExperimentContext& context);
/// "shadows": lit or not, from the hits of a view towards three lights.
void measure_relief_shadows(const ReliefExperimentContext& context);
/// "occlusion": the openness of texels, and between them.
void measure_relief_occlusion(const ReliefExperimentContext& context);
/// Pictures: a tiled sphere in light, and the reads per pixel of all methods (after [D]'s figure 9).
void draw_reliefs(const ReliefExperimentContext& context);

} // namespace kokage
