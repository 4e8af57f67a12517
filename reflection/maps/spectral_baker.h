#pragma once
// The spectral baker (DESIGN §5): harmonics of the remainder once, times each lobe's coefficients, synthesised on rings
// of the resolution that the lobe needs, read at the texels by cubic interpolation; split-off lights added as lobes.
#include "reflection/maps/baker.h"

#include <filesystem>

namespace kokage {

struct SpectralSettings {
    /// Largest error that is asked for, in radiance where the image is at most 1; above that relative to the image's
    /// remainder. Bands and grids follow from it.
    double tolerance = 1e-4;
    /// Where the prepared tables are kept between runs (a file with a checked header); empty = nowhere.
    std::filesystem::path stored_setup;
};

std::unique_ptr<Baker> spectral_baker(const TexelLayout& layout, int image_width, int image_height,
                                      const SpectralSettings& settings, WorkReport& report,
                                      Progress& progress = silent_progress());

} // namespace kokage
