#pragma once
// Builds a binary glTF: arrays become accessors of one buffer, images are embedded.
#include "common/types.h"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

namespace tinygltf {
class Model;
}

namespace kokage {

/// What an array is for: decides the buffer view's target, and whether min and max are written (glTF wants them on
/// POSITION).
enum class GltfArrayUse { vertices, positions, indices, data };

class GltfWriter {
  public:
    GltfWriter();
    ~GltfWriter();
    GltfWriter(GltfWriter&&) noexcept;

    /// Each returns the index of a new accessor; -1 for an empty array, which glTF can't hold.
    /// Throws InputError for a number that is not finite: `name` and its place are in the message.
    int add(std::span<const glm::vec2> values, GltfArrayUse use, const std::string& name);
    int add(std::span<const glm::vec3> values, GltfArrayUse use, const std::string& name);
    int add(std::span<const glm::vec4> values, GltfArrayUse use, const std::string& name);
    int add(std::span<const float> values, GltfArrayUse use, const std::string& name);
    /// Unsigned 32-bit integers.
    int add(std::span<const std::uint32_t> values, GltfArrayUse use, const std::string& name);

    /// Embeds a PNG; returns the image's index.
    int add_png(std::span<const std::byte> bytes, const std::string& name);

    /// For nodes, meshes, materials and textures. Buffers, buffer views and accessors are this class's own.
    tinygltf::Model& model();
    /// Names an extension in extensionsUsed, once.
    void use_extension(const std::string& name);
    /// `extras` of the whole file.
    void set_extras(const nlohmann::json& extras);

    /// Writes a .glb, whole or not at all. Throws InputError if it can't be written or exceeds glTF's 4 GB.
    void save(const std::filesystem::path& path) const;

  private:
    int add_array(std::span<const std::byte> bytes, std::size_t count, int component_type, int type, GltfArrayUse use,
                  const std::string& name);
    std::unique_ptr<tinygltf::Model> model_;
};

/// Invalid UTF-8 replaced by '?', as JSON can't hold it.
std::string valid_utf8(const std::string& text);

} // namespace kokage
