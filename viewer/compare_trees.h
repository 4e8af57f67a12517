#pragma once
// How far two shadings of one tree are apart.
#include "common/scene/image.h"
#include "common/services/progress.h"
#include "foliage/accuracy.h"

#include <filesystem>

namespace kokage {

struct TreeComparison {
    Accuracy accuracy; ///< of the leaves, see foliage/accuracy.h
    std::size_t leaves = 0;
    double largest = 0;           ///< relative error of a leaf side
    std::size_t largest_leaf = 0; ///< where that is
    /// The reference tree, each leaf side in the colour of its relative error, bark grey; sRGB, ready for display.
    /// Empty unless asked for.
    Image map;
    double map_scale = 0; ///< the error that has the brightest colour
};

/// Reads two files that `kokage shade` wrote and compares the first with the second. Throws InputError if one is not
/// such a file or if they are not the same tree.
TreeComparison compare_trees(const std::filesystem::path& shaded, const std::filesystem::path& reference, bool draw_map,
                             Progress& progress);

} // namespace kokage
