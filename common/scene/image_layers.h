#pragma once
// EXR files of several layers: what a picture shows, taken apart, in one file that compositing programs read.
#include "common/scene/image.h"

#include <filesystem>
#include <string>
#include <vector>

namespace kokage {

/// Channels that belong together. All are 32-bit float.
struct ImageLayer {
    std::string name;                       ///< "albedo"; empty: the picture itself
    std::vector<std::string> channel_names; ///< {"R", "G", "B"}: stored as "albedo.R", ...; one for each channel
    Image image;
};

/// Saves all in one part of an .exr file, whole or not at all (OutputFile). All are of one size. NaN is refused with
/// its place; infinity stays. Throws InputError.
void save_layers(const std::filesystem::path& path, const std::vector<ImageLayer>& layers);

/// The layers of an .exr file, in the file's order, with the channels in it that `save_layers` wrote so. Throws
/// InputError.
std::vector<ImageLayer> load_layers(const std::filesystem::path& path);

} // namespace kokage
