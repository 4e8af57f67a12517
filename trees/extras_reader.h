#pragma once
// Reads the members of `extras.kokage` (tree_extras.h). Private to trees.
#include "common/gltf/gltf_document.h"

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace kokage {

/// Whatever is missing or of the wrong kind makes `good` false, and is 0 or empty.
class ExtrasReader {
  public:
    explicit ExtrasReader(const GltfDocument& document) : document_(document) {}
    bool good = true;

    const nlohmann::json& member(const nlohmann::json& object, const char* name);
    /// An array; tinygltf writes empty ones as null, so that is empty as well.
    const nlohmann::json& list(const nlohmann::json& object, const char* name);
    std::uint64_t count(const nlohmann::json& object, const char* name);
    bool flag(const nlohmann::json& object, const char* name);
    /// Finite.
    float number(const nlohmann::json& object, const char* name);
    std::string text(const nlohmann::json& object, const char* name);
    std::vector<std::uint32_t> integers(const nlohmann::json& object, const char* name, std::uint64_t wanted);
    std::vector<float> floats(const nlohmann::json& object, const char* name, std::uint64_t wanted);
    /// Of glm::vec3 or glm::vec4.
    template <typename Vector>
    std::vector<Vector> vectors(const nlohmann::json& object, const char* name, std::uint64_t wanted);

  private:
    int index(const nlohmann::json& object, const char* name, std::uint64_t wanted, int type, int component);

    const GltfDocument& document_;
};

} // namespace kokage
