#include "common/gltf/gltf_meshopt.h"

#include "common/gltf/check_gltf.h"
#include "common/gltf/gltf_resources.h"
#include "common/services/error.h"

#include <cmath>
#include <cstdint>
#include <meshoptimizer.h>
#include <nlohmann/json.hpp>
#include <span>
#include <tiny_gltf.h>
#include <vector>

namespace kokage {
namespace {

/// What the extension's object says, checked.
struct CompressedView {
    std::span<const unsigned char> bytes;
    std::size_t stride = 0, count = 0;
    std::string mode, filter;
};

class ViewDecoder {
  public:
    ViewDecoder(const tinygltf::Model& model, const std::string& path, std::string place)
        : model_(model), path_(path), place_(std::move(place)) {}

    std::vector<unsigned char> decode(const nlohmann::json& extension) const {
        const CompressedView view = read(extension);
        check(view);
        std::vector<unsigned char> decoded(view.count * view.stride);
        if (!decoded.empty()) {
            unpack(view, decoded);
            unfilter(view, decoded);
        }
        return decoded;
    }

  private:
    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(path_ + ": " + place_ + ": its meshopt data " + what);
    }

    CompressedView read(const nlohmann::json& extension) const {
        const auto number = [&](const char* name, std::uint64_t missing) {
            return unsigned_member(extension, name, missing, path_, place_ + ", meshopt");
        };
        CompressedView view;
        const std::uint64_t none = ~std::uint64_t(0), buffer = number("buffer", none);
        const std::uint64_t offset = number("byteOffset", 0), length = number("byteLength", 0);
        if (buffer >= model_.buffers.size())
            fail("is in a buffer that does not exist");
        const std::vector<unsigned char>& data = model_.buffers[std::size_t(buffer)].data;
        if (length == 0 || offset > data.size() || length > data.size() - offset)
            fail("is not within its buffer of " + std::to_string(data.size()) + " bytes");
        view.bytes = std::span(data).subspan(std::size_t(offset), std::size_t(length));
        const std::uint64_t stride = number("byteStride", 0), count = number("count", 0);
        if (stride == 0 || stride > 256)
            fail("has a stride of " + std::to_string(stride) + "; 1 to 256 are allowed");
        view.stride = std::size_t(stride);
        // No element takes less than a 64th of a byte; also keeps count x stride from overflowing.
        if (count > 64 * length)
            fail("announces " + std::to_string(count) + " elements, more than its " + std::to_string(length) +
                 " bytes can hold");
        view.count = std::size_t(count);
        view.mode = text_member(extension, "mode", "");
        view.filter = text_member(extension, "filter", "NONE");
        return view;
    }

    static std::string text_member(const nlohmann::json& object, const char* name, const std::string& missing) {
        const auto found = object.find(name);
        return found == object.end() ? missing : found->is_string() ? found->get<std::string>() : "?";
    }

    /// The extension's own rules, and least sizes that follow from the formats: attributes take at least one bit of
    /// header a group of 16 values (2 bits, meshoptimizer's vertexcodec.cpp), triangles and index sequences a byte
    /// each.
    void check(const CompressedView& view) const {
        const bool indices = view.mode == "TRIANGLES" || view.mode == "INDICES";
        if (!indices && view.mode != "ATTRIBUTES")
            fail("has the mode '" + view.mode.substr(0, 40) + "', which is not one of the extension's");
        if (indices ? view.stride != 2 && view.stride != 4 : view.stride % 4 != 0)
            fail("has a stride of " + std::to_string(view.stride) + ", which its mode does not allow");
        if (view.mode == "TRIANGLES" && view.count % 3 != 0)
            fail("is of triangles, but its count of " + std::to_string(view.count) + " is not a multiple of 3");
        const std::size_t least = view.mode == "TRIANGLES" ? view.count / 3
                                  : view.mode == "INDICES" ? view.count
                                                           : view.count * view.stride / 64;
        if (view.bytes.size() < least)
            fail("announces " + std::to_string(view.count) + " elements, more than its " +
                 std::to_string(view.bytes.size()) + " bytes can hold");
        const bool good_filter =
            view.filter == "NONE" ||
            (!indices && ((view.filter == "OCTAHEDRAL" && (view.stride == 4 || view.stride == 8)) ||
                          (view.filter == "QUATERNION" && view.stride == 8) ||
                          (view.filter == "EXPONENTIAL" && view.stride % 4 == 0)));
        if (!good_filter)
            fail("has the filter '" + view.filter.substr(0, 40) +
                 "', which is not known or does not fit; compress it with EXT_meshopt_compression");
        // The first byte is the codec (high half) and its version (low half).
        const int header = view.bytes[0], codec = view.mode == "ATTRIBUTES"  ? 0xa0
                                                  : view.mode == "TRIANGLES" ? 0xe0
                                                                             : 0xd0;
        if ((header & 0xf0) == codec && (header & 0x0f) > (codec == 0xa0 ? 0 : 1))
            fail("is of version " + std::to_string(header & 0x0f) +
                 " of its codec, newer than what can be read; compress it with EXT_meshopt_compression");
    }

    void unpack(const CompressedView& view, std::vector<unsigned char>& decoded) const {
        const unsigned char* bytes = view.bytes.data();
        const std::size_t size = view.bytes.size();
        const int failed = view.mode == "ATTRIBUTES"
                               ? meshopt_decodeVertexBuffer(decoded.data(), view.count, view.stride, bytes, size)
                           : view.mode == "TRIANGLES"
                               ? meshopt_decodeIndexBuffer(decoded.data(), view.count, view.stride, bytes, size)
                               : meshopt_decodeIndexSequence(decoded.data(), view.count, view.stride, bytes, size);
        if (failed != 0)
            fail("is damaged; export the file again, or without mesh compression");
    }

    static void unfilter(const CompressedView& view, std::vector<unsigned char>& decoded) {
        if (view.filter == "OCTAHEDRAL")
            meshopt_decodeFilterOct(decoded.data(), view.count, view.stride);
        else if (view.filter == "QUATERNION")
            meshopt_decodeFilterQuat(decoded.data(), view.count, view.stride);
        else if (view.filter == "EXPONENTIAL")
            meshopt_decodeFilterExp(decoded.data(), view.count, view.stride);
    }

    const tinygltf::Model& model_;
    const std::string& path_;
    std::string place_;
};

} // namespace

void decode_meshopt_views(const nlohmann::json& json, tinygltf::Model& model, const std::string& path) {
    const auto views = json.find("bufferViews");
    if (views == json.end())
        return;
    std::uint64_t stored = 0, decoded = 0;
    for (const tinygltf::Buffer& buffer : model.buffers)
        stored += buffer.data.size();
    for (std::size_t i = 0; i < views->size(); ++i) {
        const nlohmann::json* extension = meshopt_extension((*views)[i]);
        if (!extension)
            continue;
        tinygltf::Buffer buffer;
        buffer.data = ViewDecoder(model, path, "bufferView " + std::to_string(i)).decode(*extension);
        decoded += buffer.data.size();
        // Views that share compressed bytes could add up to any size.
        if (decoded > 64 * stored)
            throw InputError(path + ": its meshopt data would grow to more than 64 times the file's size");
        tinygltf::BufferView& view = model.bufferViews[i];
        view.buffer = int(model.buffers.size());
        view.byteOffset = 0;
        view.byteLength = buffer.data.size();
        const auto mode = extension->find("mode");
        view.byteStride = mode != extension->end() && *mode == "ATTRIBUTES"
                              ? unsigned_member(*extension, "byteStride", 0, path, "bufferView")
                              : 0;
        model.buffers.push_back(std::move(buffer));
    }
}

} // namespace kokage
