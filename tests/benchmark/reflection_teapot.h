#pragma once
// [R] table 4: a teapot seen through a map, against the per-pixel Phong sum with the horizon's test.
#include "common/services/progress.h"
#include "tests/benchmark/reflection_record.h"

#include <filesystem>
#include <vector>

namespace kokage {

struct TeapotSettings {
    std::filesystem::path data_folder; ///< holds objects/utah_teapot.obj and env/
    std::filesystem::path pictures;    ///< where pictures and differences go; empty = none are saved
    int width = 480, height = 360;
    int cube_size = 128; ///< s of the voxel cube, and of the scale of λ
    bool quick = false;  ///< fewer environments and values of λ
};

/// For each environment and λ (1, 0.75, 0.5, 0.25 and mixed: lower half 0.1, upper half 1) one record a way to look up:
/// "shells" (cubic, per pixel, two lookups at the horizon), "shells-bilinear", "shells-one-lookup",
/// "shells-uncorrected", "cube", "exact-lookup" (no container: what the correction alone is wrong by) and "cube-paper"
/// (uncorrected, and λ r interpolated between vertices as a 3D texture's coordinate); of mixed also "shells-vertex" (λ
/// interpolated between vertices, and so in its reference). Errors are over covered pixels, after clamping to [0,1].
/// cpu_seconds is the picture's. Throws InputError if a file is missing, Stopped.
std::vector<ReflectionRecord> measure_teapot(const TeapotSettings& settings, Progress& progress = silent_progress());

} // namespace kokage
