#pragma once
// How far the layers of two pictures of `kokage render` are apart.
#include "reflection/compare_images.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace kokage {

struct LayerComparison {
    std::string name;
    /// Of layers of numbers, over the values that are finite in both.
    std::optional<DifferenceFigures> difference;
    /// So many pixels are finite in one picture alone, because what is met differs, or in neither.
    std::size_t pixels_finite_in_one = 0, pixels_finite_in_none = 0;
    /// Of depth: so many pixels are as far as the horizon in one picture or both, where a hair's breadth in the pixel
    /// is miles away. They are in no figure.
    std::size_t pixels_at_horizon = 0;
    double horizon_m = 0; ///< from there on
    /// Of layers of names (channel "id"): the share of pixels that differ. A difference of names means nothing.
    std::optional<double> differing_share;
};

/// Of each layer with the same name and channels in both, but the picture itself; nothing unless both files are .exr.
/// Throws InputError.
std::vector<LayerComparison> compare_layers(const std::filesystem::path& picture,
                                            const std::filesystem::path& reference);

} // namespace kokage
