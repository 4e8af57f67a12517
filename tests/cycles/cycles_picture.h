#pragma once
// A scene as our path tracer takes it, rendered by a program that we did not write: Cycles, in Blender.
#include "common/environment/environment.h"
#include "reflection/picture.h"

#include <filesystem>
#include <optional>
#include <vector>

namespace kokage {

/// Empty if Blender can be run here; else why not, for people.
std::optional<std::string> why_no_blender();

/// What Cycles is asked for beside the scene.
struct CyclesOptions {
    int width = 320, height = 240, samples = 64;
    int pictures = 1; ///< of as many seeds
    int threads = 2;
};

/// One picture: what surfaces send to the camera, and their share of each pixel.
struct SurfaceLight {
    Image radiance; ///< linear, 3 channels; black where nothing is met
    Image coverage; ///< 1 channel, 0 ... 1
};

/// Renders patches, looks without gloss, infinite ground (as a square of 20 km), remainder, suns and bright regions.
/// `folder` takes the scene's files; Blender's words go to blender.log there. Throws InputError for what the script
/// doesn't know (point lights, suns without a size, gloss, mirrored textures), std::runtime_error with the log's end if
/// Blender fails.
std::vector<SurfaceLight> render_in_cycles(const ShadedScene& scene, const Environment& environment,
                                           const Camera& camera, const CyclesOptions& options,
                                           const std::filesystem::path& folder);

} // namespace kokage
