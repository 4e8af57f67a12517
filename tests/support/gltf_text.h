#pragma once
// Builds small glTF files for tests: JSON with one buffer as a data URI.
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace kokage {

inline std::string base64(const std::vector<unsigned char>& bytes) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::uint32_t group = std::uint32_t(bytes[i]) << 16 |
                                    (i + 1 < bytes.size() ? std::uint32_t(bytes[i + 1]) << 8 : 0u) |
                                    (i + 2 < bytes.size() ? std::uint32_t(bytes[i + 2]) : 0u);
        text += digits[group >> 18 & 63];
        text += digits[group >> 12 & 63];
        text += i + 1 < bytes.size() ? digits[group >> 6 & 63] : '=';
        text += i + 2 < bytes.size() ? digits[group & 63] : '=';
    }
    return text;
}

/// A glTF in the making. `json` may be changed at will before it is written.
struct GltfText {
    nlohmann::json json = {{"asset", {{"version", "2.0"}}}};
    std::vector<unsigned char> bytes;
    std::vector<nlohmann::json> more_buffers; ///< listed after the one that holds `bytes`

    template <typename Value>
    int view(const std::vector<Value>& values) {
        bytes.resize((bytes.size() + 3) / 4 * 4);
        json["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", values.size() * sizeof(Value)}});
        const std::size_t at = bytes.size();
        bytes.resize(at + values.size() * sizeof(Value));
        std::memcpy(bytes.data() + at, values.data(), values.size() * sizeof(Value));
        return int(json["bufferViews"].size()) - 1;
    }
    template <typename Value>
    int accessor(const std::vector<Value>& values, const char* type, int components, int component_type) {
        const int buffer_view = view(values);
        json["accessors"].push_back({{"bufferView", buffer_view},
                                     {"componentType", component_type},
                                     {"count", values.size() / std::size_t(components)},
                                     {"type", type}});
        return int(json["accessors"].size()) - 1;
    }
    int positions(const std::vector<float>& values) {
        const int index = accessor(values, "VEC3", 3, 5126);
        return index;
    }
    int normals(const std::vector<float>& values) { return accessor(values, "VEC3", 3, 5126); }
    int uvs(const std::vector<float>& values) { return accessor(values, "VEC2", 2, 5126); }
    int indices(const std::vector<std::uint16_t>& values) { return accessor(values, "SCALAR", 1, 5123); }

    int mesh(const nlohmann::json& primitive, const std::string& name = "") {
        json["meshes"].push_back({{"primitives", {primitive}}, {"name", name}});
        return int(json["meshes"].size()) - 1;
    }
    int node(const nlohmann::json& value) {
        json["nodes"].push_back(value);
        return int(json["nodes"].size()) - 1;
    }
    void scene(const std::vector<int>& nodes) {
        json["scenes"].push_back({{"nodes", nodes}});
        json["scene"] = 0;
    }

    std::string text() const {
        return with_buffer(
                   {{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}})
            .dump();
    }
    /// The file with its bytes in another, which a URI names.
    std::string text_beside(const std::string& uri) const {
        return with_buffer({{"byteLength", bytes.size()}, {"uri", uri}}).dump();
    }
    std::string glb() const {
        std::string json_chunk = with_buffer({{"byteLength", bytes.size()}}).dump();
        json_chunk.resize((json_chunk.size() + 3) / 4 * 4, ' ');
        std::string binary(bytes.begin(), bytes.end());
        binary.resize((binary.size() + 3) / 4 * 4, '\0');
        const auto number = [](std::size_t value) {
            const auto small = std::uint32_t(value);
            std::string four(4, '\0');
            std::memcpy(four.data(), &small, 4);
            return four;
        };
        return "glTF" + number(2) + number(28 + json_chunk.size() + binary.size()) + number(json_chunk.size()) +
               "JSON" + json_chunk + number(binary.size()) + std::string("BIN\0", 4) + binary;
    }
    void write(const std::filesystem::path& path) const { std::ofstream(path, std::ios::binary) << text(); }

    /// The JSON with its buffers listed, unless it lists its own.
    nlohmann::json with_buffer(const nlohmann::json& buffer) const {
        nlohmann::json whole = json;
        if (whole.contains("buffers") || (bytes.empty() && more_buffers.empty()))
            return whole;
        whole["buffers"] = {buffer};
        for (const nlohmann::json& more : more_buffers)
            whole["buffers"].push_back(more);
        return whole;
    }

    /// A right triangle in the xy plane, front towards +Z, corners (0,0,0), (1,0,0), (0,1,0).
    static GltfText triangle() {
        GltfText file;
        const int position = file.positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
        file.mesh({{"attributes", {{"POSITION", position}}}}, "triangle");
        return file;
    }
};

} // namespace kokage
