#pragma once
// [R] table 4: a teapot seen through a map, against the per-pixel Phong sum with the horizon's test.
#include "common/services/progress.h"
#include "tests/benchmark/reflection_record.h"

#include <filesystem>
#include <functional>

namespace kokage {

struct TeapotSettings {
    std::filesystem::path data_folder; ///< holds objects/utah_teapot.obj and env/
    /// Folder of a picture for each environment and λ, teapot-<environment>-<λ>.png; empty = none are saved. From left
    /// to right: the reference, "shells", its difference, "shells-uncorrected"'s difference (white: 8 levels of 256).
    std::filesystem::path pictures;
    int width = 480, height = 360;
    int cube_size = 128; ///< s of the voxel cube, and of the scale of λ
    bool quick = false;  ///< the pattern and the photograph, λ = 0.25 and mixed
};

/// For each environment and λ (1, 0.75, 0.5, 0.25 and mixed: lower half 0.1, upper half 1) one record a way to look up:
/// "shells" (cubic, per pixel, two lookups at the horizon), "shells-bilinear", "shells-one-lookup",
/// "shells-uncorrected", "cube", "exact-lookup" (no container: what the correction alone is wrong by) and "cube-paper"
/// (uncorrected, and λ r interpolated between vertices as a 3D texture's coordinate); of mixed also "shells-vertex" (λ
/// interpolated between vertices, and so in its reference). Errors are over covered pixels, after clamping to [0,1].
/// cpu_seconds is the picture's, setup_cpu_seconds the map's set-up and bake. Throws InputError if a file is missing,
/// Stopped.
void measure_teapot(const TeapotSettings& settings, const std::function<void(const ReflectionRecord&)>& take,
                    Progress& progress = silent_progress());

} // namespace kokage
