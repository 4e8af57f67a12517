#pragma once
// `kokage grow --seeds 1..N`: many individuals of a species in a folder, with a manifest.
#include "viewer/command.h"
#include "viewer/scene/tree_source.h"

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace kokage {

struct SeedRange {
    std::uint64_t first = 1, last = 1;
};

/// "1..20". Throws InputError: not two whole numbers, the wrong way round, more than a million.
SeedRange seeds_from(std::string_view text);

/// Grows a tree for every seed into `folder` (made if it is missing): oak-7.glb for seed 7, and manifest.json, an
/// object with `species`, `parameters` (all but the seed) and `trees`: an array of {seed, file, leaves, branches,
/// triangles, height_m, width_m, bytes} in order of seeds. The manifest is written anew after every tree, each file
/// whole or not at all: what was grown when the run stops stays, and the same command goes on where it stopped. Trees
/// that the manifest lists, and whose files are as long as it says, are kept; so are those of other seeds. Throws
/// InputError if the folder holds variants of other parameters or another program's version, StoppedBetweenFiles.
void grow_variants(const TreeSource& source, const SeedRange& seeds, const std::filesystem::path& folder,
                   const CommandContext& context);

} // namespace kokage
