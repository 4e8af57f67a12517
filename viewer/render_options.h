#pragma once
// What `kokage render` can be told.
#include "viewer/scene/cli_forward.h"
#include "viewer/scene/render_scene.h"

#include <filesystem>
#include <string>
#include <vector>

namespace kokage {

struct RenderCommandOptions {
    TreeSource tree; ///< its name may be a scene file's instead
    Surroundings surroundings;
    std::string method = "fast";
    std::optional<double> error;
    std::optional<int> gather_rays;
    std::vector<std::filesystem::path> outputs; ///< .png, .exr
    std::filesystem::path report;
    std::string size; ///< empty: as the scene says
    std::optional<int> samples;
    std::optional<float> exposure_stops;
    std::optional<std::uint64_t> seed;
    std::filesystem::path data;
    bool prints_schema = false, prints_example = false;
};

void add_render_options(CLI::App& app, RenderCommandOptions& options);

struct CompleteRender {
    SceneDescription scene;
    RenderOptions options;
};

/// Reads the scene, or makes that of a tree; checks all that can be checked before the work; names outputs. Throws
/// InputError, also for options that a scene has no use for.
CompleteRender complete_render_options(const CLI::App& app, RenderCommandOptions& options);

/// True for a .json file that is, or wants to be, a scene rather than a species.
bool is_scene_file(const std::filesystem::path& file);

} // namespace kokage
