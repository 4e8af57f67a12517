#pragma once
// Image files -> Environment: read, repair, reduce, split.
#include "common/environment/environment.h"
#include "common/environment/split_lights.h"
#include "common/services/work_report.h"

#include <filesystem>
#include <optional>

namespace kokage {

struct EnvironmentLoading {
    bool strict = false;     ///< refuse bad pixels instead of repairing them
    bool split = true;       ///< split lights off
    int max_width = 4096;    ///< wider maps are reduced by whole factors to at most this (energy kept); 0 = never
    double turn_degrees = 0; ///< about +Y, from +Z towards +X, to the nearest column of pixels
    LightSplitting splitting{};
};

/// Reads a lat-long image. Integer files (PNG) are decoded from sRGB. One that is not twice as wide as high is
/// stretched over the sphere, with a warning in the report; one that is higher than wide (a cross or column of cube
/// faces, a portrait) is refused. Throws InputError with the path, and with the place under `strict`.
Environment load_environment(const std::filesystem::path& path, EnvironmentReport& report,
                             const EnvironmentLoading& loading = {});

/// The same from pixels: at least 3 channels, linear radiance. `name` is for messages and Environment::description.
Environment environment_from_image(Image image, const std::string& name, EnvironmentReport& report,
                                   const EnvironmentLoading& loading = {});

/// What was left out of an image that was wider than `max_width`, for a report; nothing if it was not.
std::optional<WorkReport::Skip> skipped_by_reduction(const EnvironmentReport& report, const Environment& environment);

/// Repairs pixels in place and counts them. The rule, per channel:
///   negative  -> 0 (-infinite too): compression and resampling leave small ones beside bright edges;
///   +infinite -> the largest finite value of that channel in the image (a sun that overflowed stays the brightest
///   thing);
///                so do values above 1e32, whose sums would overflow;
///   NaN       -> then, the mean of those of its 8 neighbours that are not NaN; where there are none, layer by layer
///   from outside.
/// Throws InputError if a channel has no good pixel at all, or under `strict` at the first bad one, with its place.
void repair_pixels(Image& image, const std::string& name, bool strict, EnvironmentReport& report);

} // namespace kokage
