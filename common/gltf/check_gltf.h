#pragma once
// What is checked in a glTF file before it is decoded. Private to common/gltf. All functions throw InputError with one
// line that begins with `path`.
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

namespace tinygltf {
class Model;
}

namespace kokage {

/// True if the bytes begin as a binary glTF.
bool is_glb(std::span<const unsigned char> bytes);

/// The JSON of a .glb (its first chunk) or a .gltf. Refuses nesting deeper than 128, which would exhaust the stack of
/// recursive readers.
nlohmann::json parse_gltf_json(std::span<const unsigned char> bytes, const std::string& path);

/// Refuses a required extension that is not understood, and geometry that exists in a compressed form alone, by the
/// extension's name.
void check_required_extensions(const nlohmann::json& json, const std::string& path);

/// Refuses buffer views that reach beyond their buffer, buffers without data, and images without a place.
void check_gltf_ranges(const nlohmann::json& json, bool binary, const std::string& path);

/// Refuses accessors that reach beyond their buffer view, and counts beyond 2^27 elements.
void check_gltf_accessors(const tinygltf::Model& model, const std::string& path);

} // namespace kokage
