#pragma once
// `kokage bench render`: error against time of the integrated renderer and of path tracing, on three scenes.
#include "common/services/progress.h"

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

namespace kokage {

struct RenderBenchmarkOptions {
    std::filesystem::path output_folder = "."; ///< render.json, render.md, plots and pictures; made if missing
    std::filesystem::path data_folder{};       ///< with the teapot; empty: a turned pot stands in for it
    std::filesystem::path references_folder{}; ///< stored truths; empty = those of the source this was built from
    std::filesystem::path cache_folder{};      ///< truths traced here; empty = output_folder/references
    bool quick = false;                        ///< 480 x 360 pixels: within five minutes on 2 cores with stored truths
    int threads = 0;                           ///< 0 = all cores; CPU seconds are of all
    bool plots = true;
    std::vector<std::string> experiments{}; ///< of render_experiment_names(); empty = all
};

/// "pictures" (error against time), "skips" (what pictures leave out, with and without).
std::vector<std::string> render_experiment_names();

/// Measures, and writes after every scene what is known so far: render.json (an array of records), render.md,
/// render-SCENE.svg, render-SCENE.png, render-SCENE-error.png. Throws InputError for an unknown experiment. Returns 0;
/// 1 if a measurement failed (the others are still made).
int run_render_benchmark(const RenderBenchmarkOptions& options, Progress& progress, std::ostream& out);

} // namespace kokage
