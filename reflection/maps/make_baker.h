#pragma once
// Any of the three bakers, by its method.
#include "reflection/maps/baker.h"
#include "reflection/maps/spectral_baker.h"
#include "reflection/maps/weight_table.h"

#include <filesystem>

namespace kokage {

struct BakerSettings {
    BakeMethod method = BakeMethod::spectral;
    double tolerance = SpectralSettings{}.tolerance; ///< spectral
    TableSettings table{};                           ///< table
    std::filesystem::path stored_setup{}; ///< spectral, table: where set-up is kept between runs; empty = nowhere
};

/// For a layout and a size of image. Adds the stages of its set-up to the report. Throws InputError, Stopped.
std::unique_ptr<Baker> make_baker(const TexelLayout& layout, int image_width, int image_height,
                                  const BakerSettings& settings, WorkReport& report,
                                  Progress& progress = silent_progress());

/// True if every pixel is the same and no light was added: any lobe then shows that same colour.
bool is_same_everywhere(const Environment& surroundings);
/// A baker for such surroundings, which filters nothing; adds to the report that it was skipped.
std::unique_ptr<Baker> same_everywhere_baker(WorkReport& report);

} // namespace kokage
