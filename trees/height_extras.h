#pragma once
// Bark's heights in `extras.kokage` (tree_extras.h): `heights`, and `relief` of `materials`. Private to trees.
#include "common/gltf/gltf_writer.h"
#include "trees/extras_reader.h"
#include "trees/tree.h"

#include <memory>
#include <span>
#include <vector>

namespace kokage {

/// Images of one channel, each once: materials share them by their number.
using BarkHeights = std::vector<std::shared_ptr<const Image>>;

BarkHeights heights_of(std::span<const TreeMaterial> materials);
nlohmann::json write_heights(GltfWriter& writer, const BarkHeights& heights);
/// Adds `relief` to the entry of a material that has heights.
void write_relief(const TreeMaterial& material, const BarkHeights& heights, nlohmann::json& entry);

/// What can't be makes `reader.good` false.
BarkHeights read_heights(ExtrasReader& reader, const nlohmann::json& extras);
void read_relief(ExtrasReader& reader, const nlohmann::json& entry, const BarkHeights& heights, TreeMaterial& material);

} // namespace kokage
