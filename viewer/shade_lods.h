#pragma once
// `kokage shade --lods`: levels of detail of a shaded tree, an impostor, and how far each is from the full tree.
#include "common/environment/environment.h"
#include "common/services/progress.h"
#include "foliage/solution.h"
#include "trees/patches.h"
#include "trees/write_tree.h"

#include <filesystem>
#include <string>
#include <vector>

namespace kokage {

/// A shaded tree, complete.
struct ShadedTree {
    const Tree& tree;
    const PatchScene& patches;
    const PatchOrigins& origins;
    const Solution& solution;
    const Environment& environment;
};

struct LodOptions {
    std::filesystem::path folder; ///< made if it is not there
    std::string stem;             ///< of the files' names
    bool split_sides = false;
    int levels = 3; ///< coarser meshes beside the full one
    int cards = 4;  ///< of the impostor: an oak from seven sides had errors of 3.1, 1.9 and 1.2 with 2, 3 and 4
    int picture_height = 384; ///< of each view, pixels; the impostor's cards have as many texels
};

/// Throws InputError, before any work, if the folder is a file or can't be made or written.
void check_lod_folder(const std::filesystem::path& folder);

/// One of the full tree, its coarser meshes and its impostor, against the full tree.
struct LodFigures {
    std::string file; ///< its name in the folder
    std::size_t leaves = 0, triangles = 0;
    double image_mre = 0; ///< mean relative error of the picture's pixels, at full size
    int times_as_far = 1;
    double image_mre_from_afar = 0; ///< the same from so many times as far, for which it is meant
};

struct WrittenLods {
    std::vector<std::filesystem::path> files;
    std::vector<LodFigures> levels; ///< as the picture's columns
};

/// Writes STEM_lod0.glb (the full tree) to STEM_lod3.glb, STEM_impostor.glb, STEM_lods.png and STEM_lods.json. The
/// picture has a column for each, full tree first: as it looks from a side that no card faces; its error against the
/// full tree (dark 0, pale yellow 1, as error_legend); and as it looks from 1, 2, 4 ... times as far, for which it is
/// meant. The figures: leaves, triangles, leaf area, mean radiance, and the mean relative error of the picture's
/// pixels, from two sides, at full size and from as far as it is meant for.
WrittenLods write_lods(const ShadedTree& shaded, const LodOptions& options, Progress& progress);

} // namespace kokage
