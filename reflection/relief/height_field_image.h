#pragma once
// Height maps as images -> relief. White is high: a height of 1 is depth 0.
#include "common/scene/image.h"
#include "reflection/relief/height_field.h"

#include <filesystem>
#include <string>
#include <vector>

namespace kokage {

struct Relief {
    HeightField field;
    ReliefScale scale;
};

struct HeightImageOptions {
    HeightWrap wrap = HeightWrap::repeat;
    bool black_is_high = false;      ///< the image holds depths
    bool strict = false;             ///< refuse NaN and infinite heights instead of repairing them
    bool luminance_of_color = false; ///< take a coloured image by its luminance instead of refusing it
    bool stretch = false;            ///< use the whole range of depths, also where the image does not leave [0, 1]
    bool make_tile = false;          ///< repeat without a seam: periodic_part (tiling.h)
};

/// What was done to an image, for the user.
struct HeightImageReport {
    std::size_t repaired = 0;       ///< NaN and infinite texels, filled from those around them (repair_texels.h)
    float least = 0, most = 1;      ///< of the image's heights, before anything was stretched
    glm::dvec2 seam{1.};            ///< of a repeated map: seam_steps (tiling.h) of the relief that came out
    std::vector<std::string> notes; ///< one line each
};

/// Relief from an image of heights as numbers (never decoded from sRGB), any size. One channel; or grey in three, alpha
/// is left out; a coloured image is refused unless options say otherwise. `scale.depth_m` is what a difference of 1 in
/// the image measures.
///
/// Heights within [0, 1], so all from integer files, are taken as they are. Others (metres in a float file, say) are
/// stretched to [0, 1], and depth_m with them, so that the relief measures the same: a float file in metres comes with
/// depth_m 1. What a map spans beyond what a float holds is refused. `name` is for messages. Throws InputError.
Relief relief_from_image(const Image& image, const ReliefScale& scale, const std::string& name,
                         const HeightImageOptions& options, HeightImageReport& report);

/// The same from an image file of any format that load_image reads, 8 or 16 bit or float.
Relief load_relief(const std::filesystem::path& path, const ReliefScale& scale, const HeightImageOptions& options,
                   HeightImageReport& report);

/// Throws InputError unless tile_m is finite and > 0 and depth_m finite and >= 0.
void check_relief_scale(const ReliefScale& scale);

} // namespace kokage
