#include "common/gltf/check_gltf.h"

#include "common/gltf/gltf_document.h"
#include "common/services/error.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string_view>
#include <tiny_gltf.h>
#include <utility>
#include <vector>

namespace kokage {
namespace {

constexpr std::array<std::string_view, 31> kUnderstood = {
    // Read.
    "KHR_texture_transform", "KHR_materials_unlit", "KHR_materials_diffuse_transmission", "KHR_mesh_quantization",
    "EXT_texture_webp", "KHR_materials_pbrSpecularGlossiness", "KHR_materials_transmission",
    "KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression", "EXT_mesh_gpu_instancing",
    // Can't be decoded: a stated substitute where nothing but a colour is lost, else refused by the material's name.
    "KHR_texture_basisu", "MSFT_texture_dds", "EXT_texture_avif",
    // Don't change shape or diffuse colour.
    "KHR_materials_ior", "KHR_materials_specular", "KHR_materials_sheen", "KHR_materials_clearcoat",
    "KHR_materials_volume", "KHR_materials_emissive_strength", "KHR_materials_iridescence", "KHR_materials_anisotropy",
    "KHR_materials_dispersion", "KHR_materials_volume_scatter", "KHR_lights_punctual", "KHR_materials_variants",
    "KHR_xmp_json_ld", "KHR_xmp", "KHR_animation_pointer", "EXT_mesh_features", "EXT_instance_features"};

[[noreturn]] void fail(const std::string& path, const std::string& what) {
    throw InputError(path + ": " + what);
}

[[noreturn]] void fail_version(const std::string& path, const std::string& version) {
    fail(path, "is glTF version " + version +
                   "; version 2 is needed (gltf-pipeline converts: gltf-pipeline -i old.gltf -o new.glb)");
}

/// In version 1, meshes and their like are objects by name, and "asset" may be missing.
void check_version(const nlohmann::json& json, const std::string& path) {
    std::string version;
    if (const auto asset = json.find("asset"); asset != json.end() && asset->is_object())
        if (const auto said = asset->find("version"); said != asset->end() && said->is_string())
            version = said->get<std::string>().substr(0, 20);
    const auto meshes = json.find("meshes");
    if (version.starts_with("0.") || version.starts_with("1.") || version == "1" ||
        (meshes != json.end() && meshes->is_object()))
        fail_version(path, version.empty() ? "1" : version);
}

std::uint32_t little_endian(const unsigned char* bytes) {
    return std::uint32_t(bytes[0]) | std::uint32_t(bytes[1]) << 8 | std::uint32_t(bytes[2]) << 16 |
           std::uint32_t(bytes[3]) << 24;
}

/// The part of the file that holds JSON.
std::string_view json_text(std::span<const unsigned char> bytes, const std::string& path) {
    if (!is_glb(bytes))
        return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
    if (bytes.size() < 20)
        fail(path, "cut off: a GLB header takes 20 bytes, the file has " + std::to_string(bytes.size()));
    const std::uint32_t version = little_endian(bytes.data() + 4), length = little_endian(bytes.data() + 8);
    const std::uint32_t chunk = little_endian(bytes.data() + 12);
    if (version != 2)
        fail_version(path, std::to_string(version));
    if (length > bytes.size() || std::uint64_t(chunk) + 20 > bytes.size())
        fail(path, "cut off: its header announces " +
                       std::to_string(std::max<std::uint64_t>(length, std::uint64_t(chunk) + 20)) +
                       " bytes, the file has " + std::to_string(bytes.size()));
    return {reinterpret_cast<const char*>(bytes.data()) + 20, chunk};
}

/// The member's elements, none if it is missing; refuses what is not an array.
const nlohmann::json& array_of(const nlohmann::json& json, const char* name, const std::string& path) {
    static const nlohmann::json none = nlohmann::json::array();
    const auto found = json.find(name);
    if (found == json.end())
        return none;
    if (!found->is_array())
        fail(path, std::string("\"") + name + "\" is not an array");
    return *found;
}

/// "cut off" or "broken at line 2, column 7"; `byte` counts from 1.
std::string place_of_fault(std::string_view text, std::size_t byte) {
    if (byte > text.size())
        return text.empty() ? "empty" : "cut off";
    const std::string_view before = text.substr(0, byte > 0 ? byte - 1 : 0);
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    const std::size_t line_begin = before.find_last_of('\n') + 1; // npos + 1 is 0
    return "broken at line " + std::to_string(line) + ", column " + std::to_string(before.size() - line_begin + 1);
}

} // namespace

std::uint64_t unsigned_member(const nlohmann::json& object, const char* name, std::uint64_t missing,
                              const std::string& path, const std::string& place) {
    if (!object.is_object())
        fail(path, place + " is not an object");
    const auto found = object.find(name);
    if (found == object.end())
        return missing;
    if (!found->is_number_unsigned())
        fail(path, place + ": \"" + name + "\" is " + found->dump().substr(0, 40) + ", not an unsigned integer");
    return found->get<std::uint64_t>();
}

std::span<const std::string_view> understood_gltf_extensions() {
    return kUnderstood;
}

bool is_glb(std::span<const unsigned char> bytes) {
    return bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0;
}

nlohmann::json parse_gltf_json(std::span<const unsigned char> bytes, const std::string& path) {
    const std::string_view text = json_text(bytes, path);
    try {
        const auto watch_depth = [&](int depth, nlohmann::json::parse_event_t, nlohmann::json&) {
            if (depth > 128)
                fail(path, "its JSON is nested more than 128 levels deep");
            return true;
        };
        nlohmann::json json = nlohmann::json::parse(text.begin(), text.end(), watch_depth);
        if (json.is_object())
            check_version(json, path);
        if (!json.is_object() || !json.contains("asset"))
            fail(path, "is not a glTF file: its JSON has no \"asset\"");
        return json;
    } catch (const nlohmann::json::parse_error& error) {
        fail(path, "is not a glTF file: its JSON is " + place_of_fault(text, error.byte));
    } catch (const nlohmann::json::exception&) {
        fail(path, "is not a glTF file: its JSON holds a number out of range");
    }
}

void check_required_extensions(const nlohmann::json& json, const std::string& path) {
    for (const nlohmann::json& extension : array_of(json, "extensionsRequired", path)) {
        if (!extension.is_string())
            fail(path, "\"extensionsRequired\" holds something that is not a name");
        const std::string name = extension.get<std::string>();
        if (std::find(kUnderstood.begin(), kUnderstood.end(), name) == kUnderstood.end())
            fail(path,
                 "requires the extension " + name + ", which is not understood; export it without that extension");
    }
}

namespace {

/// From the roots on, without recursion; what this doesn't reach (cycles) and children that don't exist are refused
/// where nodes are read.
void check_depth_of_nodes(const nlohmann::json& json, const std::string& path) {
    const nlohmann::json& nodes = array_of(json, "nodes", path);
    std::vector<std::int64_t> parent(nodes.size(), -1);
    for (std::size_t i = 0; i < nodes.size(); ++i)
        if (nodes[i].is_object() && nodes[i].contains("children"))
            for (const nlohmann::json& child : nodes[i]["children"])
                if (child.is_number_unsigned() && child.get<std::uint64_t>() < nodes.size())
                    parent[child.get<std::size_t>()] = std::int64_t(i);
    std::vector<std::size_t> level, next;
    for (std::size_t i = 0; i < nodes.size(); ++i)
        if (parent[i] < 0)
            level.push_back(i);
    for (std::size_t depth = 1; !level.empty(); ++depth) {
        if (depth > kMaximumNodeDepth)
            fail(path, "its nodes are nested deeper than the limit of " + std::to_string(kMaximumNodeDepth) +
                           "; join them in the program that it comes from");
        next.clear();
        for (const std::size_t node : level)
            if (nodes[node].is_object() && nodes[node].contains("children"))
                for (const nlohmann::json& child : nodes[node]["children"])
                    if (child.is_number_unsigned() && child.get<std::uint64_t>() < nodes.size() &&
                        std::exchange(parent[child.get<std::size_t>()], -1) == std::int64_t(node))
                        next.push_back(child.get<std::size_t>());
        std::swap(level, next);
    }
}

} // namespace

void check_gltf_ranges(const nlohmann::json& json, const std::string& path) {
    std::vector<std::uint64_t> buffer_sizes;
    for (const nlohmann::json& buffer : array_of(json, "buffers", path)) {
        const std::string place = "buffer " + std::to_string(buffer_sizes.size());
        const std::uint64_t size = unsigned_member(buffer, "byteLength", 0, path, place);
        if (size == 0)
            fail(path, place + " is empty");
        if (buffer.contains("uri") && !buffer["uri"].is_string())
            fail(path, place + ": \"uri\" is not a string");
        buffer_sizes.push_back(size);
    }
    std::size_t view_index = 0;
    for (const nlohmann::json& view : array_of(json, "bufferViews", path)) {
        const std::string place = "bufferView " + std::to_string(view_index++);
        const std::uint64_t buffer = unsigned_member(view, "buffer", ~std::uint64_t(0), path, place);
        const std::uint64_t offset = unsigned_member(view, "byteOffset", 0, path, place);
        const std::uint64_t length = unsigned_member(view, "byteLength", 0, path, place);
        if (buffer >= buffer_sizes.size())
            fail(path, place + ": there is no buffer " + std::to_string(buffer));
        if (offset > buffer_sizes[buffer] || length > buffer_sizes[buffer] - offset || length == 0)
            fail(path, place + ": bytes " + std::to_string(offset) + " + " + std::to_string(length) +
                           " are not within its buffer of " + std::to_string(buffer_sizes[buffer]));
        if (length > 0x7fffffffu)
            fail(path, place + ": larger than 2 GB");
    }
    std::size_t accessor_index = 0;
    for (const nlohmann::json& accessor : array_of(json, "accessors", path)) {
        const std::string place = "accessor " + std::to_string(accessor_index++);
        if (!accessor.is_object())
            fail(path, place + " is not an object");
        const auto count = accessor.find("count");
        if (count == accessor.end() || !count->is_number() || count->get<double>() < 0)
            fail(path, place + ": \"count\" is " + (count == accessor.end() ? "missing" : count->dump().substr(0, 40)) +
                           ", not an unsigned integer");
    }
    check_depth_of_nodes(json, path);
    std::size_t image_index = 0;
    for (const nlohmann::json& image : array_of(json, "images", path)) {
        const std::string place = "image " + std::to_string(image_index++);
        if (unsigned_member(image, "bufferView", 0, path, place) >= view_index && image.contains("bufferView"))
            fail(path, place + ": its bufferView does not exist");
        if (image.contains("uri") && (!image["uri"].is_string() || image["uri"].get_ref<const std::string&>().empty()))
            fail(path, place + ": \"uri\" is not a name");
    }
}

namespace {

void check_span(const tinygltf::Model& model, int view_index, std::uint64_t offset, std::uint64_t count,
                std::uint64_t element, bool strided, const std::string& place, const std::string& path) {
    if (view_index < 0 || std::size_t(view_index) >= model.bufferViews.size())
        fail(path, place + ": its bufferView does not exist");
    const tinygltf::BufferView& view = model.bufferViews[std::size_t(view_index)];
    if (std::size_t(view.buffer) >= model.buffers.size() ||
        view.byteOffset + view.byteLength > model.buffers[std::size_t(view.buffer)].data.size())
        fail(path, place + ": its bufferView is not within its buffer");
    const std::uint64_t stride = strided && view.byteStride ? view.byteStride : element;
    if (strided && view.byteStride && view.byteStride < element)
        fail(path, place + ": elements of " + std::to_string(element) + " bytes do not fit a stride of " +
                       std::to_string(stride));
    if (count > 0 && (offset > view.byteLength || (count - 1) * stride + element > view.byteLength - offset))
        fail(path, place + ": " + std::to_string(count) + " elements reach beyond its bufferView of " +
                       std::to_string(view.byteLength) + " bytes");
}

bool known_component(int type) {
    return type >= TINYGLTF_COMPONENT_TYPE_BYTE && type <= TINYGLTF_COMPONENT_TYPE_FLOAT &&
           type != TINYGLTF_COMPONENT_TYPE_INT;
}

} // namespace

void check_gltf_accessors(const tinygltf::Model& model, const std::string& path) {
    for (std::size_t i = 0; i < model.accessors.size(); ++i) {
        const tinygltf::Accessor& accessor = model.accessors[i];
        const std::string place = "accessor " + std::to_string(i);
        if (!known_component(accessor.componentType))
            fail(path, place + ": component type " + std::to_string(accessor.componentType) + " is not one of glTF's");
        if (accessor.count > kMaximumElements)
            fail(path, place + ": " + std::to_string(accessor.count) + " elements are more than the limit of " +
                           std::to_string(kMaximumElements));
        const std::uint64_t element =
            std::uint64_t(tinygltf::GetComponentSizeInBytes(std::uint32_t(accessor.componentType)) *
                          tinygltf::GetNumComponentsInType(std::uint32_t(accessor.type)));
        if (accessor.bufferView >= 0)
            check_span(model, accessor.bufferView, accessor.byteOffset, accessor.count, element, true, place, path);
        if (!accessor.sparse.isSparse)
            continue;
        const auto& sparse = accessor.sparse;
        const int index_type = sparse.indices.componentType;
        if (sparse.count < 0 || std::size_t(sparse.count) > accessor.count || sparse.indices.byteOffset < 0 ||
            sparse.values.byteOffset < 0 ||
            (index_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
             index_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
             index_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT))
            fail(path, place + ": its sparse part is not valid");
        check_span(model, sparse.indices.bufferView, std::uint64_t(sparse.indices.byteOffset),
                   std::uint64_t(sparse.count),
                   std::uint64_t(tinygltf::GetComponentSizeInBytes(std::uint32_t(index_type))), false, place, path);
        check_span(model, sparse.values.bufferView, std::uint64_t(sparse.values.byteOffset),
                   std::uint64_t(sparse.count), element, false, place, path);
    }
}

} // namespace kokage
