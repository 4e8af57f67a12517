#include "common/gltf/gltf_document.h"

#include "common/gltf/check_gltf.h"
#include "common/services/error.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <tiny_gltf.h>

namespace kokage {

struct GltfDocument::Implementation {
    std::string path;
    nlohmann::json json;
    tinygltf::Model model;
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

std::vector<unsigned char> read_bytes(const std::filesystem::path& path) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error))
        throw InputError(path.string() +
                         (std::filesystem::exists(path, error) ? ": not a regular file" : ": no such file"));
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    if (!file)
        throw InputError(path.string() + ": cannot be opened for reading");
    const std::streamoff size = file.tellg();
    if (size > std::streamoff(0xffffffffu))
        throw InputError(path.string() + ": larger than 4 GB, which glTF does not allow");
    std::vector<unsigned char> bytes(std::size_t(std::max<std::streamoff>(size, 0)));
    file.seekg(0);
    if (!file.read(reinterpret_cast<char*>(bytes.data()), size))
        throw InputError(path.string() + ": could not be read to its end");
    return bytes;
}

/// tinygltf may not decode images (stb_image is not part of Debian's build): it hands over the encoded bytes, which are
/// kept.
bool keep_encoded_image(tinygltf::Image* image, const int, std::string*, std::string*, int, int,
                        const unsigned char* bytes, int size, void*) {
    if (size > 0)
        image->image.assign(bytes, bytes + size);
    image->as_is = true;
    return true;
}

std::string first_line(std::string text) {
    text.erase(std::find(text.begin(), text.end(), '\n'), text.end());
    return text.empty() ? "not a valid glTF file" : text;
}

} // namespace

GltfDocument GltfDocument::read(const std::filesystem::path& path, Progress& progress) {
    auto document = std::make_unique<Implementation>();
    document->path = path.string();
    const std::vector<unsigned char> bytes = read_bytes(path);
    progress.throw_if_stopped();
    const bool binary = is_glb(bytes);
    document->json = parse_gltf_json(bytes, document->path);
    check_required_extensions(document->json, document->path);
    check_gltf_ranges(document->json, binary, document->path);
    progress.throw_if_stopped();

    tinygltf::TinyGLTF loader;
    loader.SetImageLoader(keep_encoded_image, nullptr);
    std::string error, warning;
    const std::string folder = path.has_parent_path() ? path.parent_path().string() : std::string(".");
    bool loaded = false;
    try {
        loaded = binary ? loader.LoadBinaryFromMemory(&document->model, &error, &warning, bytes.data(),
                                                      static_cast<unsigned>(bytes.size()), folder)
                        : loader.LoadASCIIFromString(&document->model, &error, &warning,
                                                     reinterpret_cast<const char*>(bytes.data()),
                                                     static_cast<unsigned>(bytes.size()), folder);
    } catch (const std::exception& failure) {
        error = failure.what();
    }
    if (!loaded)
        throw InputError(document->path + ": " + first_line(error));
    GltfDocument result(std::move(document));
    check_gltf_accessors(result.model(), result.path());
    return result;
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

std::vector<float> GltfDocument::floats(int index, int components) const {
    const tinygltf::Accessor& accessor = accessor_at(*this, index);
    const int found = tinygltf::GetNumComponentsInType(std::uint32_t(accessor.type));
    if (found != components)
        fail("accessor " + std::to_string(index) + " has " + std::to_string(found) + " components an element where " +
             std::to_string(components) + " are needed");
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
    std::vector<std::uint32_t> values(accessor.count, 0u);
    for_each_element(model(), accessor, [&](std::size_t element, const unsigned char* bytes) {
        values[element] = component_as_unsigned(bytes, accessor.componentType);
    });
    return values;
}

std::span<const unsigned char> GltfDocument::image_bytes(int index) const {
    const auto& images = model().images;
    if (index < 0 || std::size_t(index) >= images.size())
        fail("image " + std::to_string(index) + " does not exist; the file has " + std::to_string(images.size()));
    const tinygltf::Image& image = images[std::size_t(index)];
    if (image.image.empty())
        fail("image " + std::to_string(index) +
             (image.uri.empty() ? " is empty" : " (" + image.uri + ") could not be read: put it beside the file"));
    return image.image;
}

} // namespace kokage
