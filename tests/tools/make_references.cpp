// Makes the references of the benchmark's scenes:
//
//     kokage_make_references CACHE_FOLDER PATHS_A_SIDE THREADS [SCENE]...      (all scenes of leaves if none is named)
//     kokage_make_references CACHE_FOLDER PATHS_A_PIXEL THREADS pictures       (truths of the renderer's pictures)
//
// It takes hours; stop it whenever you like: it goes on where it was. Copy the finished *.reference files to
// tests/benchmark/references. KOKAGE_DATA must name the data folder for the lamp-lit scenes.
#include "common/services/error.h"
#include "common/services/parallel.h"
#include "common/services/stopwatch.h"
#include "tests/benchmark/benchmark_plan.h"
#include "tests/benchmark/find_reference.h"
#include "tests/benchmark/render_plan.h"
#include "tests/benchmark/render_scenes.h"
#include "tests/benchmark/render_truth.h"

#include <algorithm>
#include <cstdlib>
#include <iomanip>
#include <iostream>

namespace kokage {
namespace {

std::vector<BenchSceneName> wanted_scenes(const std::vector<std::string>& only) {
    std::vector<BenchSceneName> names;
    for (const PlannedScene& planned : benchmark_plan(false)) {
        const bool wanted = only.empty() || std::find(only.begin(), only.end(), to_string(planned.name)) != only.end();
        if (wanted && planned.name.light != BenchLight::furnace) // whose truth is known
            names.push_back(planned.name);
    }
    return names;
}

void make(const std::vector<BenchSceneName>& names, const ReferenceOptions& options) {
    const char* data = std::getenv("KOKAGE_DATA");
    BenchScenes scenes(data ? data : "");
    for (const BenchSceneName& name : names) {
        if (const std::string reason = scenes.why_not(name); !reason.empty()) {
            std::cout << "skipped: " << to_string(name) << ": " << reason << std::endl;
            continue;
        }
        const Stopwatch watch;
        // A chunk is what is lost when the work is stopped: about a minute.
        ReferenceOptions of_scene = options;
        of_scene.paths_per_chunk = name.leaves > 50000 ? 64 : 256;
        const Reference made = find_or_make_reference(scenes.make(name), of_scene, silent_progress());
        std::cout << to_string(name) << ": " << made.paths_per_side << " paths a leaf side, noise " << std::fixed
                  << std::setprecision(3) << 100 * made.noise << " %, " << std::setprecision(1) << watch.cpu()
                  << " CPU-s" << std::endl;
    }
}

void make_pictures(const std::filesystem::path& cache, std::uint64_t samples) {
    const char* data = std::getenv("KOKAGE_DATA");
    for (const bool quick : {true, false}) {
        const RenderPlan plan = render_plan(quick);
        for (const SceneDescription& description : render_scenes(plan.width, plan.height, data ? data : "", cache)) {
            const Stopwatch watch;
            const PictureTruth truth =
                find_truth(assemble_scene(description, silent_progress()), judged_pixels(plan, description.picture),
                           description.name, {{}, cache, samples}, silent_progress());
            std::cout << truth_file_name(description.name, description.picture) << ": " << truth.samples
                      << " paths a pixel, noise " << std::fixed << std::setprecision(3) << 100 * truth.noise << " %, "
                      << std::setprecision(1) << watch.cpu() << " CPU-s" << std::endl;
        }
    }
}

} // namespace
} // namespace kokage

int main(int count, char** arguments) {
    if (count < 4) {
        std::cerr << "usage: kokage_make_references CACHE_FOLDER PATHS_A_SIDE THREADS [SCENE]...\n";
        return 2;
    }
    kokage::ReferenceOptions options;
    options.cache_folder = arguments[1];
    options.stored_folder = arguments[1];
    options.paths_per_side = std::strtoull(arguments[2], nullptr, 10);
    kokage::set_thread_count(std::atoi(arguments[3]));
    try {
        const std::vector<std::string> scenes(arguments + 4, arguments + count);
        if (scenes == std::vector<std::string>{"pictures"})
            kokage::make_pictures(options.cache_folder, options.paths_per_side);
        else
            kokage::make(kokage::wanted_scenes(scenes), options);
    } catch (const kokage::InputError& error) {
        std::cerr << error.what() << "\n";
        return 2;
    }
}
