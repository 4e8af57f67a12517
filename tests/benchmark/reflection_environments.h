#pragma once
// The surroundings that reflection maps are measured in.
#include "common/environment/environment.h"

#include <filesystem>
#include <string>
#include <vector>

namespace kokage {

/// [R] section 7's colour pattern, 512 x 256: hue once round across, HSL saturation 0 at the top row to 1 at the bottom
/// row, lightness 0.5. Its values are radiance as they stand (the paper's are brightness levels; no transfer curve).
Image colour_pattern();

/// What stands for the paper's photograph: overcast_potsdamer_platz.hdr of the data folder, halved to 512 x 256 by
/// 2 x 2 boxes, clamped to [0,1]. Throws InputError if the file is missing.
Image photograph(const std::filesystem::path& data_folder);

/// Dim grey with one pixel of radiance 1e6, some 35 degrees up: 512 x 256.
Image lone_sun();

/// The three HDR images that relative errors are judged on, as file names in the data folder's env: a sun among clouds,
/// lamps in a room, a night with street lamps.
const std::vector<std::string>& real_hdr_files();

/// A file of the data folder's env, repaired, not split, reduced to `width` columns. Throws InputError.
Image real_hdr(const std::filesystem::path& data_folder, const std::string& file, int width);

/// An image as surroundings without lights apart: what a Baker takes.
Environment unsplit(Image image, std::string description);

} // namespace kokage
