#pragma once
// The paper's baker ([R] section 6): a pyramid of images on geodesic domes, and a table of weights that is made once.
#include "reflection/maps/baker.h"
#include "reflection/maps/weight_table.h"

#include <filesystem>

namespace kokage {

struct TableBakerSettings {
    TableSettings table{};
    /// The table is read from here if the file is there, else made and written here; empty = kept in memory alone.
    std::filesystem::path stored_table{};
};

/// Serves images of any size: an image of more than 512 x 256 pixels is reduced to that first, as coarse as the paper
/// has it. Lights of the image are split off before and added as lobes, as the spectral baker does, except with
/// TableWeights::paper, which is as published: there an image with lights gives a warning. Error: what the thresholds
/// cut off, and the blur of a dome's spacing, which is about a tenth of the lobe's width (see weight_table.h); lobes
/// narrower than the finest dome's spacing (0.9 degrees) show the dome itself. Images of less than 400 columns are
/// interpolated between pixels, which blurs them: baking them gives a warning with about how much. Throws InputError,
/// Stopped.
std::unique_ptr<Baker> table_baker(const TexelLayout& layout, const TableBakerSettings& settings, WorkReport& report,
                                   Progress& progress = silent_progress());

} // namespace kokage
