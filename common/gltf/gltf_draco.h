#pragma once
// KHR_draco_mesh_compression, by libdraco. Private to common/gltf.
#include "common/services/progress.h"

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace tinygltf {
class Model;
}

namespace kokage {

/// Decodes every compressed primitive into new accessors, to which the primitive's indices and attributes then point;
/// each buffer view is decoded once. libdraco checks most of what it reads, but takes memory for as many faces and
/// vertices as a file announces: those counts are read and judged first. Throws InputError with one line that begins
/// with `path`.
void decode_draco_primitives(const nlohmann::json& json, tinygltf::Model& model, const std::string& path,
                             Progress& progress);

} // namespace kokage
