#pragma once
// Private to common/gltf.
#include "common/gltf/gltf_scene.h"

namespace kokage {

/// All materials of a file plus a default one at the end; the base colour images are decoded once each.
std::vector<GltfMaterial> read_gltf_materials(const GltfDocument& document, Progress& progress);

} // namespace kokage
