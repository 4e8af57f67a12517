#pragma once
// What is checked in a glTF file before it is decoded. Private to common/gltf. All functions throw InputError with one
// line that begins with `path`.
#include <cstdint>
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
/// recursive readers; and glTF of version 1.
nlohmann::json parse_gltf_json(std::span<const unsigned char> bytes, const std::string& path);

/// The most elements of an accessor.
inline constexpr std::size_t kMaximumElements = std::size_t(1) << 27;

/// The most places of meshes in a scene, instances counted singly; and of meshes that come out of it.
inline constexpr std::size_t kMaximumInstances = std::size_t(1) << 22;
inline constexpr std::size_t kMaximumMeshes = std::size_t(1) << 20;

/// The most nodes from a root down to a leaf.
inline constexpr std::size_t kMaximumNodeDepth = 1000;

/// Refuses a required extension that is not understood, by its name.
void check_required_extensions(const nlohmann::json& json, const std::string& path);

/// Refuses buffers without a length, buffer views that reach beyond their buffer, negative counts of accessors, images
/// without a place, and nodes deeper than kMaximumNodeDepth.
/// What it lets pass are arrays of objects with numbers of the right kind.
void check_gltf_ranges(const nlohmann::json& json, const std::string& path);

/// Refuses accessors that reach beyond their buffer view, and counts beyond kMaximumElements.
void check_gltf_accessors(const tinygltf::Model& model, const std::string& path);

/// A member that is an unsigned integer; `missing` if it is not there. Refuses what is of another kind.
std::uint64_t unsigned_member(const nlohmann::json& object, const char* name, std::uint64_t missing,
                              const std::string& path, const std::string& place);

} // namespace kokage
