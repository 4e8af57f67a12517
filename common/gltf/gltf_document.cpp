#include "common/gltf/gltf_document.h"

#include "common/gltf/check_gltf.h"
#include "common/gltf/gltf_draco.h"
#include "common/gltf/gltf_meshopt.h"
#include "common/gltf/gltf_resources.h"
#include "common/services/error.h"
#include "common/services/named_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <tiny_gltf.h>

namespace kokage {

struct GltfDocument::Implementation {
    std::string path;
    nlohmann::json json;
    tinygltf::Model model;
    std::size_t stored_bytes = 0;                               ///< of all buffers as the file holds them
    mutable std::map<int, std::vector<unsigned char>> images{}; ///< that lie in no buffer, read when they are asked for
};

GltfDocument::GltfDocument(std::unique_ptr<Implementation> implementation)
    : implementation_(std::move(implementation)) {}
GltfDocument::~GltfDocument() = default;
GltfDocument::GltfDocument(GltfDocument&&) noexcept = default;
GltfDocument& GltfDocument::operator=(GltfDocument&&) noexcept = default;

const tinygltf::Model& GltfDocument::model() const {
    return implementation_->model;
}
const nlohmann::json& GltfDocument::json() const {
    return implementation_->json;
}
const std::string& GltfDocument::path() const {
    return implementation_->path;
}
void GltfDocument::fail(const std::string& what) const {
    throw InputError(implementation_->path + ": " + what);
}

const nlohmann::json& GltfDocument::extras() const {
    static const nlohmann::json none;
    const auto found = implementation_->json.find("extras");
    return found == implementation_->json.end() ? none : *found;
}

namespace {

std::string first_line(std::string text) {
    text.erase(std::find(text.begin(), text.end(), '\n'), text.end());
    return text.empty() ? "not a valid glTF file" : text;
}

} // namespace

namespace {

/// What tinygltf is given: the file's structure alone. Bytes are our own business (read_gltf_buffers), and it refuses
/// indices that lie in no buffer view, as those of Draco: they get one for the while.
nlohmann::json structure_for_tinygltf(const nlohmann::json& json, std::vector<std::size_t>& without_view) {
    nlohmann::json structure;
    for (const char* name : {"asset", "scene", "scenes", "nodes", "meshes", "accessors", "materials", "textures",
                             "samplers", "skins", "extensionsUsed", "extensionsRequired"})
        if (const auto found = json.find(name); found != json.end())
            structure[name] = *found;
    const auto views = json.find("bufferViews");
    const std::size_t count = views == json.end() ? 0 : views->size();
    const nlohmann::json stand_in = {{"buffer", 0}, {"byteLength", 1}};
    structure["bufferViews"] = nlohmann::json::array();
    for (std::size_t i = 0; i <= count; ++i)
        structure["bufferViews"].push_back(stand_in);
    if (const auto accessors = structure.find("accessors"); accessors != structure.end() && accessors->is_array())
        for (std::size_t i = 0; i < accessors->size(); ++i)
            if (nlohmann::json& accessor = (*accessors)[i]; accessor.is_object() && !accessor.contains("bufferView")) {
                accessor["bufferView"] = count;
                without_view.push_back(i);
            }
    return structure;
}

tinygltf::Model parse_structure(const nlohmann::json& json, const std::string& path) {
    tinygltf::TinyGLTF loader;
    tinygltf::Model model;
    std::vector<std::size_t> without_view;
    std::string error, warning;
    bool loaded = false;
    try {
        const std::string text = structure_for_tinygltf(json, without_view).dump();
        loaded =
            loader.LoadASCIIFromString(&model, &error, &warning, text.data(), static_cast<unsigned>(text.size()), ".");
    } catch (const std::exception& failure) {
        error = failure.what();
    }
    if (!loaded)
        throw InputError(path + ": " + first_line(error));
    for (const std::size_t accessor : without_view)
        model.accessors[accessor].bufferView = -1;
    return model;
}

/// Buffers and buffer views as the file has them; check_gltf_ranges() has seen them. tinygltf would refuse strides that
/// are no multiple of 4, which some exporters write.
void add_buffers(const nlohmann::json& json, std::vector<std::vector<unsigned char>> buffers, tinygltf::Model& model,
                 const std::string& path) {
    model.buffers.resize(buffers.size());
    for (std::size_t i = 0; i < buffers.size(); ++i)
        model.buffers[i].data = std::move(buffers[i]);
    model.bufferViews.clear();
    const auto views = json.find("bufferViews");
    if (views == json.end())
        return;
    for (const nlohmann::json& source : *views) {
        const std::string place = "bufferView " + std::to_string(model.bufferViews.size());
        tinygltf::BufferView& view = model.bufferViews.emplace_back();
        view.buffer = int(unsigned_member(source, "buffer", 0, path, place));
        view.byteOffset = unsigned_member(source, "byteOffset", 0, path, place);
        view.byteLength = unsigned_member(source, "byteLength", 0, path, place);
        view.byteStride = std::min<std::uint64_t>(unsigned_member(source, "byteStride", 0, path, place), 1u << 20);
    }
}

} // namespace

GltfDocument GltfDocument::read(const std::filesystem::path& path, Progress& progress) {
    auto document = std::make_unique<Implementation>();
    document->path = path.string();
    std::vector<unsigned char> bytes = read_file_bytes(path, 0xffffffffu);
    progress.throw_if_stopped();
    const bool binary = is_glb(bytes);
    document->json = parse_gltf_json(bytes, document->path);
    const nlohmann::json& json = document->json;
    check_required_extensions(json, document->path);
    check_gltf_ranges(json, document->path);
    progress.throw_if_stopped();

    tinygltf::Model& model = document->model;
    model = parse_structure(json, document->path);
    add_buffers(json, read_gltf_buffers(json, std::move(bytes), binary, path), model, document->path);
    for (const tinygltf::Buffer& buffer : model.buffers)
        document->stored_bytes += buffer.data.size();
    progress.throw_if_stopped();
    decode_meshopt_views(json, model, document->path);
    check_gltf_accessors(model, document->path);
    decode_draco_primitives(json, model, document->path, progress);
    return GltfDocument(std::move(document));
}

namespace {

const tinygltf::Accessor& accessor_at(const GltfDocument& document, int accessor) {
    const auto& accessors = document.model().accessors;
    if (accessor < 0 || std::size_t(accessor) >= accessors.size())
        document.fail("accessor " + std::to_string(accessor) + " does not exist; the file has " +
                      std::to_string(accessors.size()));
    return accessors[std::size_t(accessor)];
}

template <typename T>
T load(const unsigned char* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return value;
}

/// One component as glTF 2.0, section 3.6.2.2 ("Accessor data types") and 3.11 (normalised integers) say.
float component_as_float(const unsigned char* bytes, int type, bool normalized) {
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: {
        const float value = load<std::int8_t>(bytes);
        return normalized ? std::max(value / 127.f, -1.f) : value;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: {
        const float value = load<std::uint8_t>(bytes);
        return normalized ? value / 255.f : value;
    }
    case TINYGLTF_COMPONENT_TYPE_SHORT: {
        const float value = load<std::int16_t>(bytes);
        return normalized ? std::max(value / 32767.f, -1.f) : value;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: {
        const float value = load<std::uint16_t>(bytes);
        return normalized ? value / 65535.f : value;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return float(load<std::uint32_t>(bytes));
    default:
        return load<float>(bytes);
    }
}

std::uint32_t component_as_unsigned(const unsigned char* bytes, int type) {
    if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE)
        return load<std::uint8_t>(bytes);
    if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT)
        return load<std::uint16_t>(bytes);
    return load<std::uint32_t>(bytes);
}

/// Calls read(element, bytes) for every element of an accessor, base values first, then the sparse ones.
template <typename Read>
void for_each_element(const tinygltf::Model& model, const tinygltf::Accessor& accessor, const Read& read) {
    const std::size_t element_size =
        std::size_t(tinygltf::GetComponentSizeInBytes(std::uint32_t(accessor.componentType)) *
                    tinygltf::GetNumComponentsInType(std::uint32_t(accessor.type)));
    if (accessor.bufferView >= 0) {
        const tinygltf::BufferView& view = model.bufferViews[std::size_t(accessor.bufferView)];
        const unsigned char* bytes =
            model.buffers[std::size_t(view.buffer)].data.data() + view.byteOffset + accessor.byteOffset;
        const std::size_t stride = view.byteStride ? view.byteStride : element_size;
        for (std::size_t i = 0; i < accessor.count; ++i)
            read(i, bytes + i * stride);
    }
    if (!accessor.sparse.isSparse)
        return;
    const auto& indices = accessor.sparse.indices;
    const auto& values = accessor.sparse.values;
    const tinygltf::BufferView& index_view = model.bufferViews[std::size_t(indices.bufferView)];
    const tinygltf::BufferView& value_view = model.bufferViews[std::size_t(values.bufferView)];
    const unsigned char* index_bytes = model.buffers[std::size_t(index_view.buffer)].data.data() +
                                       index_view.byteOffset + std::size_t(indices.byteOffset);
    const unsigned char* value_bytes = model.buffers[std::size_t(value_view.buffer)].data.data() +
                                       value_view.byteOffset + std::size_t(values.byteOffset);
    const std::size_t index_size = std::size_t(tinygltf::GetComponentSizeInBytes(std::uint32_t(indices.componentType)));
    for (std::size_t i = 0; i < std::size_t(accessor.sparse.count); ++i) {
        const std::uint32_t element = component_as_unsigned(index_bytes + i * index_size, indices.componentType);
        if (element < accessor.count)
            read(element, value_bytes + i * element_size);
    }
}

} // namespace

std::size_t GltfDocument::accessor_count(int accessor) const {
    return accessor_at(*this, accessor).count;
}

void GltfDocument::check_data(int index) const {
    const tinygltf::Accessor& accessor = accessor_at(*this, index);
    if (accessor.bufferView < 0 && accessor.count > implementation_->stored_bytes)
        fail("accessor " + std::to_string(index) + ": " + std::to_string(accessor.count) +
             " elements, but no data for them");
}

std::vector<float> GltfDocument::floats(int index, int components) const {
    const tinygltf::Accessor& accessor = accessor_at(*this, index);
    const int found = tinygltf::GetNumComponentsInType(std::uint32_t(accessor.type));
    if (found != components)
        fail("accessor " + std::to_string(index) + " has " + std::to_string(found) + " components an element where " +
             std::to_string(components) + " are needed");
    check_data(index);
    const std::size_t size = std::size_t(tinygltf::GetComponentSizeInBytes(std::uint32_t(accessor.componentType)));
    std::vector<float> values(accessor.count * std::size_t(components), 0.f);
    for_each_element(model(), accessor, [&](std::size_t element, const unsigned char* bytes) {
        for (int c = 0; c < components; ++c)
            values[element * std::size_t(components) + std::size_t(c)] =
                component_as_float(bytes + std::size_t(c) * size, accessor.componentType, accessor.normalized);
    });
    return values;
}

std::vector<std::uint32_t> GltfDocument::unsigned_integers(int index) const {
    const tinygltf::Accessor& accessor = accessor_at(*this, index);
    if (accessor.type != TINYGLTF_TYPE_SCALAR || (accessor.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
                                                  accessor.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
                                                  accessor.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT))
        fail("accessor " + std::to_string(index) + " does not hold unsigned integers");
    check_data(index);
    std::vector<std::uint32_t> values(accessor.count, 0u);
    for_each_element(model(), accessor, [&](std::size_t element, const unsigned char* bytes) {
        values[element] = component_as_unsigned(bytes, accessor.componentType);
    });
    return values;
}

std::size_t GltfDocument::image_count() const {
    const auto images = json().find("images");
    return images == json().end() ? 0 : images->size();
}

std::span<const unsigned char> GltfDocument::image_bytes(int index) const {
    if (index < 0 || std::size_t(index) >= image_count())
        fail("image " + std::to_string(index) + " does not exist; the file has " + std::to_string(image_count()));
    const nlohmann::json& image = json()["images"][std::size_t(index)];
    const std::string place = "image " + std::to_string(index);
    if (const auto view_index = image.find("bufferView"); view_index != image.end()) {
        const tinygltf::BufferView& view = model().bufferViews[view_index->get<std::size_t>()];
        const std::vector<unsigned char>& data = model().buffers[std::size_t(view.buffer)].data;
        if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset)
            fail(place + " is not within its buffer");
        return std::span(data).subspan(view.byteOffset, view.byteLength);
    }
    const auto uri = image.find("uri");
    if (uri == image.end())
        fail(place + " has neither \"uri\" nor \"bufferView\"");
    auto [found, is_new] = implementation_->images.try_emplace(index);
    if (is_new) {
        const std::string& name = uri->get_ref<const std::string&>();
        if (is_data_uri(name)) {
            found->second = data_uri_bytes(name, path(), place);
        } else {
            const std::filesystem::path file = path();
            found->second = read_file_bytes(
                find_named_file(file.parent_path(), name, NameReach::relative, path() + ": " + place), 0xffffffffu);
        }
    }
    return found->second;
}

} // namespace kokage
