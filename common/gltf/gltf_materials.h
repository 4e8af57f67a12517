#pragma once
// Private to common/gltf.
#include "common/gltf/gltf_document.h"
#include "common/scene/mesh_scene.h"

namespace kokage {

/// All materials of a file plus a default one at the end; the base colour images are decoded once each. A texture in a
/// format that can't be decoded (KTX2/BasisU, DDS, AVIF) is passed over where nothing but a colour is lost (`notes`
/// says so, SceneMaterial::color_is_lost), and refused where it may hold an alpha mask.
std::vector<SceneMaterial> read_gltf_materials(const GltfDocument& document, std::vector<std::string>& notes,
                                               Progress& progress);

} // namespace kokage
