#pragma once
// The spectral baker (DESIGN §5): harmonics of the remainder once, times each lobe's coefficients, synthesised on rings
// of the resolution that the lobe needs, read at the texels by splines; split-off lights added as lobes. It computes
// what brute_force_baker.h sums: every pixel a point of light at its centre, divided by the sum of the weights.
//
// A layout of few lobes (shells, mips) has a grid for each; one of many (the voxel cube) reads four neighbouring grids.
// Of lobes narrower than 0.7 pixels, or of more than 512 bands, what is near their axis is summed pixel by pixel
// (near_sums.h): all of a Phong lobe, of GGX what harmonics can't hold. Of what is below 0 within the
// tolerance 0 is made; the report warns if it was more.
#include "reflection/maps/baker.h"

#include <filesystem>

namespace kokage {

struct SpectralSettings {
    /// Largest error that is asked for, in radiance where the image is at most 1; above that relative to the image's
    /// brightest remainder. Bands, grids and shells follow from it. Photographs stay at about half of it, noise of
    /// single pixels at about it; Phong's edge at a right angle (Λ < 0.05) may exceed it several times.
    double tolerance = 1.5e-4;
    /// Where the prepared tables are kept between runs (a file with a checked header, made if it is not there); empty =
    /// nowhere. Saves little: preparing is fast.
    std::filesystem::path stored_setup;
};

std::unique_ptr<Baker> spectral_baker(const TexelLayout& layout, int image_width, int image_height,
                                      const SpectralSettings& settings, WorkReport& report,
                                      Progress& progress = silent_progress());

} // namespace kokage
