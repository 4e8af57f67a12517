#pragma once
// EXT_meshopt_compression (and KHR_meshopt_compression, where the data is of the version that libmeshoptimizer reads).
// Private to common/gltf.
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace tinygltf {
class Model;
}

namespace kokage {

/// Decodes every compressed buffer view into a buffer of its own, to which the view then points. Before memory is taken
/// for a view: its numbers are as the extension asks, and the count that it announces can be held by its compressed
/// bytes (no codec packs more than 64 bytes into one). Throws InputError with one line that begins with `path`.
void decode_meshopt_views(const nlohmann::json& json, tinygltf::Model& model, const std::string& path);

} // namespace kokage
