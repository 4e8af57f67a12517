#pragma once
// Voxel cubes and shells as OpenEXR files, with everything in their headers that is needed to read them back.
//
// Pixels: shells as shell_atlas.h lays them out; a cube of n³ voxels as n slices of n x n, z = 0 at the top: n wide,
// n² high, x to the right, y downwards, each slice a tile of the file. R, G, B, halves or floats. Text attributes:
//
//   both    kokage:map             "shells" or "voxel cube"
//           kokage:layout_version  2
//           kokage:lobe            "phong" or "ggx"
//           kokage:format          texel_format_name; values of a shared exponent are stored as halves, which hold them
//           kokage:made_from       one line about the surroundings; may be missing
//           kokage:checksum        of the pixels and of all the above and below
//   shells  kokage:least_parameter, kokage:most_parameter, kokage:shell_ratio, kokage:texels_a_width, kokage:filter
//                                  ShellSettings; they fix the layout
//           kokage:shells          for other programs: "parameter width resolution x y" of each shell, ';' between
//   cube    kokage:cube_size, kokage:levels, kokage:u     RoughnessScale: s, I, u
//           kokage:smoothness      "0.3 0.6": VoxelCube::range(), λ of the rough and of the smooth end; with s it fixes
//           n
#include "reflection/maps/exr_notes.h"
#include "reflection/maps/shell_map.h"
#include "reflection/maps/voxel_cube.h"

#include <filesystem>
#include <functional>
#include <string>
#include <variant>

namespace kokage {

/// Whole or not at all (OutputFile). Throws InputError for values that are not finite, and where it can't be written.
/// Reading back gives the same texels, bit by bit.
void write_map(const std::filesystem::path& path, const ShellMap& map, const std::string& made_from = "",
               ExrCompression compression = ExrCompression::zip);
/// `format`: half_rgb or float_rgb (float: the same voxels bit by bit; half: rounded).
void write_map(const std::filesystem::path& path, const VoxelCube& cube, TexelFormat format = TexelFormat::half_rgb,
               const std::string& made_from = "", ExrCompression compression = ExrCompression::zip);

/// The same in two steps: what the file needs is copied, and the function that is returned writes it, while the map may
/// be changed. Either step throws InputError.
std::function<void()> packed_map(const std::filesystem::path& path, const ShellMap& map, const std::string& made_from,
                                 ExrCompression compression);
std::function<void()> packed_map(const std::filesystem::path& path, const VoxelCube& cube, TexelFormat format,
                                 const std::string& made_from, ExrCompression compression);

struct MapFile {
    std::variant<ShellMap, VoxelCube> map;
    std::string made_from;
};
/// Throws InputError, one line that begins with the path: no map, another version, cut off, altered, a size that its
/// settings contradict.
MapFile read_map(const std::filesystem::path& path);
/// Whether it is an EXR file that says that it is such a map (it may be damaged all the same).
bool is_map_file(const std::filesystem::path& path);
/// Throws InputError if it is: maps would pass for images of surroundings, as they are pictures to EXR readers.
void check_is_no_map(const std::filesystem::path& path);

} // namespace kokage
