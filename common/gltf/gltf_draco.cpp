#include "common/gltf/gltf_draco.h"

#include "common/gltf/check_gltf.h"
#include "common/scene/mesh_scene.h"
#include "common/services/error.h"

#include <cstdint>
#include <cstring>
#include <draco/compression/decode.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <tiny_gltf.h>
#include <vector>

namespace kokage {
namespace {

constexpr const char* kExtension = "KHR_draco_mesh_compression";
constexpr const char* kAdvice = "; export the file again, or without mesh compression";
/// A flat regular grid of a million vertices, about as good as it gets, takes a byte for 38 faces (libdraco 1.5.5 at
/// its slowest).
constexpr std::uint64_t kMostFacesAByte = 256;

/// What a stream announces before its connectivity (Draco bitstream 2.2, sections "Header" and "Connectivity").
struct Announced {
    std::uint32_t faces = 0, points = 0;
};

class PrimitiveDecoder {
  public:
    PrimitiveDecoder(tinygltf::Model& model, const std::string& path) : model_(model), path_(path) {}

    void decode(tinygltf::Primitive& primitive, const nlohmann::json& extension, const std::string& place) {
        const std::uint64_t view =
            unsigned_member(extension, "bufferView", ~std::uint64_t(0), path_, place + ", " + kExtension);
        if (view >= model_.bufferViews.size())
            fail(place, "is in a bufferView that does not exist");
        Decoded& decoded = decoded_[std::size_t(view)];
        if (!decoded.mesh) {
            decoded.mesh = decode_mesh(std::size_t(view), place);
            decoded.indices = add_indices(*decoded.mesh, place);
        }
        primitive.indices = decoded.indices;
        primitive.mode = TINYGLTF_MODE_TRIANGLES; // faces come out as triangles, also of what was a strip
        const auto attributes = extension.find("attributes");
        if (attributes == extension.end() || !attributes->is_object())
            fail(place, "names no attributes");
        for (const auto& [name, id] : attributes->items()) {
            const auto wanted = primitive.attributes.find(name);
            if (wanted == primitive.attributes.end())
                continue; // glTF does not use it
            if (!id.is_number_unsigned() || id.get<std::uint64_t>() > 0xffffffffu)
                fail(place, "gives " + name + " an identifier that is no number");
            const auto unique = id.get<std::uint32_t>();
            const draco::PointAttribute* attribute = decoded.mesh->GetAttributeByUniqueId(unique);
            if (!attribute)
                fail(place, "has no attribute " + std::to_string(unique) + ", which should be " + name);
            const auto [known, is_new] = decoded.accessors.try_emplace({unique, wanted->second}, -1);
            if (is_new)
                known->second = add_attribute(*decoded.mesh, *attribute, wanted->second, place + ", " + name);
            wanted->second = known->second;
        }
    }

  private:
    struct Decoded {
        std::unique_ptr<draco::Mesh> mesh;
        int indices = -1;
        std::map<std::pair<std::uint32_t, int>, int> accessors; ///< of Draco's identifier and the file's accessor
    };

    [[noreturn]] void fail(const std::string& place, const std::string& what) const {
        throw InputError(path_ + ": " + place + ": its Draco data " + what);
    }

    /// The numbers of faces and points that the stream announces; libdraco itself takes memory for them unseen.
    Announced announced(std::span<const unsigned char> bytes, const std::string& place) const {
        const auto damaged = [&]() { fail(place, std::string("is damaged") + kAdvice); };
        draco::DecoderBuffer buffer;
        buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        struct {
            char name[5];
            std::uint8_t major, minor, type, method;
            std::uint16_t flags;
        } header{};
        if (!buffer.Decode(header.name, 5) || !buffer.Decode(&header.major) || !buffer.Decode(&header.minor) ||
            !buffer.Decode(&header.type) || !buffer.Decode(&header.method) || !buffer.Decode(&header.flags) ||
            std::memcmp(header.name, "DRACO", 5) != 0)
            damaged();
        if (header.major != 2 || header.minor != 2)
            fail(place, "is of version " + std::to_string(header.major) + "." + std::to_string(header.minor) +
                            "; glTF asks for 2.2" + kAdvice);
        if (header.type != draco::TRIANGULAR_MESH || header.method > draco::MESH_EDGEBREAKER_ENCODING)
            fail(place, std::string("is not of triangles") + kAdvice);
        buffer.set_bitstream_version(DRACO_BITSTREAM_VERSION(2, 2));
        if (header.flags & METADATA_FLAG_MASK) {
            draco::GeometryMetadata ignored;
            if (!draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &ignored))
                damaged();
        }
        Announced counts;
        std::uint8_t traversal = 0;
        const bool read =
            header.method == draco::MESH_SEQUENTIAL_ENCODING
                ? draco::DecodeVarint(&counts.faces, &buffer) && draco::DecodeVarint(&counts.points, &buffer)
                : buffer.Decode(&traversal) && draco::DecodeVarint(&counts.points, &buffer) &&
                      draco::DecodeVarint(&counts.faces, &buffer);
        if (!read)
            damaged();
        return counts;
    }

    std::unique_ptr<draco::Mesh> decode_mesh(std::size_t view_index, const std::string& place) const {
        const tinygltf::BufferView& view = model_.bufferViews[view_index];
        const std::vector<unsigned char>& data = model_.buffers[std::size_t(view.buffer)].data;
        if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset)
            fail(place, "is not within its buffer");
        const std::span<const unsigned char> bytes = std::span(data).subspan(view.byteOffset, view.byteLength);
        const Announced counts = announced(bytes, place);
        const std::uint64_t most = std::min(kMostFacesAByte * bytes.size(), std::uint64_t(kMaximumSceneTriangles));
        if (counts.faces > most || counts.points > 3 * std::uint64_t(counts.faces))
            fail(place, "announces " + std::to_string(counts.faces) + " faces and " + std::to_string(counts.points) +
                            " vertices, more than its " + std::to_string(bytes.size()) + " bytes can hold" + kAdvice);
        draco::DecoderBuffer buffer;
        buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        draco::Decoder decoder;
        auto result = decoder.DecodeMeshFromBuffer(&buffer);
        if (!result.ok())
            fail(place, std::string("is damaged") + kAdvice);
        return std::move(result).value();
    }

    int add_accessor(std::vector<unsigned char> bytes, std::size_t count, int component_type, int type,
                     bool normalized) const {
        tinygltf::Buffer buffer;
        tinygltf::BufferView view;
        view.buffer = int(model_.buffers.size());
        view.byteLength = bytes.size();
        buffer.data = std::move(bytes);
        tinygltf::Accessor accessor;
        accessor.bufferView = int(model_.bufferViews.size());
        accessor.count = count;
        accessor.componentType = component_type;
        accessor.type = type;
        accessor.normalized = normalized;
        model_.buffers.push_back(std::move(buffer));
        model_.bufferViews.push_back(std::move(view));
        model_.accessors.push_back(std::move(accessor));
        return int(model_.accessors.size()) - 1;
    }

    int add_indices(const draco::Mesh& mesh, const std::string& place) const {
        std::vector<unsigned char> bytes(std::size_t(mesh.num_faces()) * 3 * sizeof(std::uint32_t));
        for (std::uint32_t f = 0; f < mesh.num_faces(); ++f)
            for (std::size_t c = 0; c < 3; ++c) {
                const std::uint32_t point = mesh.face(draco::FaceIndex(f))[c].value();
                if (point >= mesh.num_points())
                    fail(place, std::string("is damaged") + kAdvice);
                std::memcpy(bytes.data() + (std::size_t(f) * 3 + c) * sizeof point, &point, sizeof point);
            }
        return add_accessor(std::move(bytes), std::size_t(mesh.num_faces()) * 3, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
                            TINYGLTF_TYPE_SCALAR, false);
    }

    /// The attribute's values at all points, in the component type of the accessor that the file declares for it.
    int add_attribute(const draco::Mesh& mesh, const draco::PointAttribute& attribute, int declared_index,
                      const std::string& place) const {
        if (declared_index < 0 || std::size_t(declared_index) >= model_.accessors.size())
            fail(place, "belongs to an accessor that does not exist");
        const tinygltf::Accessor declared = model_.accessors[std::size_t(declared_index)];
        const int components = tinygltf::GetNumComponentsInType(std::uint32_t(declared.type));
        if (components < 1 || components > 4 || attribute.num_components() != components)
            fail(place, "has " + std::to_string(attribute.num_components()) + " components where the accessor has " +
                            std::to_string(components));
        std::vector<unsigned char> bytes;
        switch (declared.componentType) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            bytes = values<std::int8_t>(mesh, attribute, place);
            break;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            bytes = values<std::uint8_t>(mesh, attribute, place);
            break;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            bytes = values<std::int16_t>(mesh, attribute, place);
            break;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            bytes = values<std::uint16_t>(mesh, attribute, place);
            break;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            bytes = values<std::uint32_t>(mesh, attribute, place);
            break;
        default:
            bytes = values<float>(mesh, attribute, place);
        }
        return add_accessor(std::move(bytes), mesh.num_points(), declared.componentType, declared.type,
                            declared.normalized);
    }

    template <typename Value>
    std::vector<unsigned char> values(const draco::Mesh& mesh, const draco::PointAttribute& attribute,
                                      const std::string& place) const {
        const auto components = std::size_t(attribute.num_components());
        std::vector<unsigned char> bytes(std::size_t(mesh.num_points()) * components * sizeof(Value));
        if (!attribute.is_mapping_identity() && attribute.indices_map_size() < mesh.num_points())
            fail(place, std::string("is damaged") + kAdvice);
        for (std::uint32_t p = 0; p < mesh.num_points(); ++p) {
            const draco::AttributeValueIndex index = attribute.mapped_index(draco::PointIndex(p));
            Value value[4] = {};
            if (index.value() >= attribute.size() ||
                !attribute.ConvertValue<Value>(index, std::int8_t(components), value))
                fail(place, std::string("is damaged") + kAdvice);
            std::memcpy(bytes.data() + p * components * sizeof(Value), value, components * sizeof(Value));
        }
        return bytes;
    }

    tinygltf::Model& model_;
    const std::string& path_;
    std::map<std::size_t, Decoded> decoded_; ///< by buffer view
};

} // namespace

void decode_draco_primitives(const nlohmann::json& json, tinygltf::Model& model, const std::string& path,
                             Progress& progress) {
    const auto meshes = json.find("meshes");
    if (meshes == json.end())
        return;
    PrimitiveDecoder decoder(model, path);
    for (std::size_t m = 0; m < model.meshes.size(); ++m)
        for (std::size_t p = 0; p < model.meshes[m].primitives.size(); ++p) {
            const nlohmann::json& primitive = (*meshes)[m].at("primitives")[p];
            const auto extensions = primitive.find("extensions");
            if (extensions == primitive.end() || !extensions->is_object() || !extensions->contains(kExtension))
                continue;
            progress.throw_if_stopped();
            decoder.decode(model.meshes[m].primitives[p], (*extensions)[kExtension],
                           "mesh " + std::to_string(m) + ", primitive " + std::to_string(p));
        }
}

} // namespace kokage
