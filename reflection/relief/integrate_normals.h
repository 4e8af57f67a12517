#pragma once
// Relief from a normal map, where there are no heights.
#include "reflection/relief/height_field_image.h"

namespace kokage {

/// Which way a normal map's green points.
enum class NormalMapGreen {
    up,   ///< +Y, "OpenGL", glTF: towards the image's upper edge, so towards smaller v
    down, ///< -Y, "DirectX": towards its lower edge
};

struct NormalMapOptions {
    HeightWrap wrap = HeightWrap::repeat;
    NormalMapGreen green = NormalMapGreen::up;
    glm::vec2 tile_m{1.f}; ///< what the tile that the map covers measures; heights grow with it
    bool strict = false;   ///< refuse texels that hold no normal instead of repairing them
};

/// What was done to a normal map, for the user.
struct NormalMapReport {
    std::size_t repaired = 0; ///< texels that hold no normal (NaN, infinite, facing down, of length < 0.1 or > 10)
    std::size_t steep = 0;    ///< slopes beyond kSteepestSlope, reduced to it
    /// Root mean square of the slopes that no height field has (the map's curl) over that of all slopes: about 0 for
    /// a map that was made from heights, large if green points the other way than said.
    double curl = 0;
    std::vector<std::string> notes; ///< one line each
};

inline constexpr double kSteepestSlope = 16; ///< 86.4 degrees; 8 bits tell no more

/// The heights whose slopes come nearest to the normals', in the sense of least squares over the whole map: R. T.
/// Frankot, R. Chellappa, A Method for Enforcing Integrability in Shape from Shading Algorithms (1988), eq 21, by
/// Fourier transforms. A repeated tile is periodic; a clamped one is mirrored at its edges first, so that it is free
/// to end at other heights than it began.
///
/// The map holds unit normals in the tangent frame, 0..1 for -1..1, as relief_normal gives them (their length does not
/// matter); slopes are metres over metres, so that heights come out in metres of `tile_m`: scale.depth_m is what they
/// span, and the highest texel has depth 0. The slopes' mean is taken off: the relief lies level on the whole. Slopes
/// know nothing of absolute height, and 8-bit ones little of unevenness much wider than the details. At least 3
/// channels (further ones are left out). Throws InputError.
Relief relief_from_normals(const Image& image, const std::string& name, const NormalMapOptions& options,
                           NormalMapReport& report);

/// The same from an image file of any format that load_image reads.
Relief load_relief_from_normals(const std::filesystem::path& path, const NormalMapOptions& options,
                                NormalMapReport& report);

} // namespace kokage
