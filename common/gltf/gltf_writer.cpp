#include "common/gltf/gltf_writer.h"

#include "common/services/error.h"
#include "common/services/output_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <tiny_gltf.h>

namespace kokage {
namespace {

void refuse_not_finite(std::span<const float> values, std::size_t components, const std::string& name) {
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!std::isfinite(values[i]))
            throw InputError("can't write a glTF: " + name + " " + std::to_string(i / components) + " is " +
                             std::to_string(values[i]));
}

template <typename Vector>
std::span<const float> components_of(std::span<const Vector> values) {
    return {reinterpret_cast<const float*>(values.data()), values.size() * std::size_t(Vector::length())};
}

tinygltf::Value value_from(const nlohmann::json& json) {
    if (json.is_object()) {
        tinygltf::Value::Object object;
        for (const auto& [key, value] : json.items())
            object[key] = value_from(value);
        return tinygltf::Value(object);
    }
    if (json.is_array()) {
        tinygltf::Value::Array array;
        for (const nlohmann::json& value : json)
            array.push_back(value_from(value));
        return tinygltf::Value(array);
    }
    if (json.is_boolean())
        return tinygltf::Value(json.get<bool>());
    if (json.is_number_integer())
        return tinygltf::Value(json.get<int>());
    if (json.is_number())
        return tinygltf::Value(json.get<double>());
    if (json.is_string())
        return tinygltf::Value(valid_utf8(json.get<std::string>()));
    return {};
}

/// Bytes behind those that are there already, at a multiple of four. Returns the view's index.
int append_view(tinygltf::Model& model, std::span<const std::byte> bytes) {
    std::vector<unsigned char>& buffer = model.buffers[0].data;
    buffer.resize((buffer.size() + 3) / 4 * 4);
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = buffer.size();
    view.byteLength = bytes.size();
    const auto* begin = reinterpret_cast<const unsigned char*>(bytes.data());
    buffer.insert(buffer.end(), begin, begin + bytes.size());
    model.bufferViews.push_back(std::move(view));
    return int(model.bufferViews.size()) - 1;
}

} // namespace

GltfWriter::GltfWriter() : model_(std::make_unique<tinygltf::Model>()) {
    model_->asset.version = "2.0";
    model_->asset.generator = "Kokage";
    model_->buffers.emplace_back();
}
GltfWriter::~GltfWriter() = default;
GltfWriter::GltfWriter(GltfWriter&&) noexcept = default;

tinygltf::Model& GltfWriter::model() {
    return *model_;
}

int GltfWriter::add_array(std::span<const std::byte> bytes, std::size_t count, int component_type, int type,
                          GltfArrayUse use, const std::string& name) {
    if (count == 0)
        return -1;
    tinygltf::Accessor accessor;
    accessor.bufferView = append_view(*model_, bytes);
    model_->bufferViews.back().target = use == GltfArrayUse::indices ? TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER
                                        : use == GltfArrayUse::data  ? 0
                                                                     : TINYGLTF_TARGET_ARRAY_BUFFER;
    accessor.componentType = component_type;
    accessor.count = count;
    accessor.type = type;
    accessor.name = valid_utf8(name);
    model_->accessors.push_back(std::move(accessor));
    return int(model_->accessors.size()) - 1;
}

int GltfWriter::add(std::span<const glm::vec2> values, GltfArrayUse use, const std::string& name) {
    refuse_not_finite(components_of(values), 2, name);
    return add_array(std::as_bytes(values), values.size(), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC2, use,
                     name);
}

int GltfWriter::add(std::span<const glm::vec3> values, GltfArrayUse use, const std::string& name) {
    refuse_not_finite(components_of(values), 3, name);
    const int index =
        add_array(std::as_bytes(values), values.size(), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, use, name);
    if (use == GltfArrayUse::positions && index >= 0) {
        glm::vec3 low = values[0], high = values[0];
        for (const glm::vec3& value : values) {
            low = glm::min(low, value);
            high = glm::max(high, value);
        }
        model_->accessors.back().minValues = {low.x, low.y, low.z};
        model_->accessors.back().maxValues = {high.x, high.y, high.z};
    }
    return index;
}

int GltfWriter::add(std::span<const glm::vec4> values, GltfArrayUse use, const std::string& name) {
    refuse_not_finite(components_of(values), 4, name);
    return add_array(std::as_bytes(values), values.size(), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC4, use,
                     name);
}

int GltfWriter::add(std::span<const float> values, GltfArrayUse use, const std::string& name) {
    refuse_not_finite(values, 1, name);
    return add_array(std::as_bytes(values), values.size(), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_SCALAR, use,
                     name);
}

int GltfWriter::add(std::span<const std::uint32_t> values, GltfArrayUse use, const std::string& name) {
    return add_array(std::as_bytes(values), values.size(), TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR,
                     use, name);
}

int GltfWriter::add_png(std::span<const std::byte> bytes, const std::string& name) {
    tinygltf::Image image;
    image.bufferView = append_view(*model_, bytes);
    image.mimeType = "image/png";
    image.name = valid_utf8(name);
    model_->images.push_back(std::move(image));
    return int(model_->images.size()) - 1;
}

void GltfWriter::use_extension(const std::string& name) {
    std::vector<std::string>& used = model_->extensionsUsed;
    if (std::find(used.begin(), used.end(), name) == used.end())
        used.push_back(name);
}

void GltfWriter::set_extras(const nlohmann::json& extras) {
    model_->extras = value_from(extras);
}

void GltfWriter::save(const std::filesystem::path& path) const {
    if (model_->buffers[0].data.size() > std::size_t(0xf0000000u))
        throw InputError(path.string() + ": " + std::to_string(model_->buffers[0].data.size()) +
                         " bytes are more than a binary glTF can hold (4 GB)");
    tinygltf::Model copy;
    const tinygltf::Model* model = model_.get();
    if (model_->buffers[0].data.empty()) { // a buffer without bytes is not valid
        copy = *model_;
        copy.buffers.clear();
        model = &copy;
    }
    OutputFile file(path);
    tinygltf::TinyGLTF writer;
    if (!writer.WriteGltfSceneToStream(model, file.stream(), false, true))
        throw InputError(path.string() + ": could not be written");
    file.commit();
}

std::string valid_utf8(const std::string& text) {
    // nlohmann's serialiser knows UTF-8: let it replace what is not, and take the string back.
    const std::string dumped = nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    return nlohmann::json::parse(dumped).get<std::string>();
}

} // namespace kokage
