#pragma once
// The bytes that a glTF file refers to: buffers and images, inside of it, in data URIs, or in files of their own.
// Private to common/gltf. All functions throw InputError with one line that begins with the document's path.
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

namespace kokage {

/// The bytes of a data URI ("data:...;base64,..." or percent-encoded text); `place` is for messages.
std::vector<unsigned char> data_uri_bytes(const std::string& uri, const std::string& path, const std::string& place);
bool is_data_uri(const std::string& uri);

/// One entry a buffer. Buffers that nothing but compressed views refer to (fallbacks, EXT_meshopt_compression) stay
/// empty. `file` is the document's own bytes; a .glb's binary chunk is moved out of it. Every buffer is as long as its
/// byteLength says.
std::vector<std::vector<unsigned char>> read_gltf_buffers(const nlohmann::json& json, std::vector<unsigned char> file,
                                                          bool binary, const std::filesystem::path& path);

/// The extension's object if a buffer view is compressed with EXT_meshopt_compression or KHR_meshopt_compression; else
/// null.
const nlohmann::json* meshopt_extension(const nlohmann::json& view);

} // namespace kokage
