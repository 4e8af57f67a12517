#include "common/gltf/gltf_resources.h"

#include "common/services/error.h"
#include "common/services/named_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>

namespace kokage {
namespace {

constexpr std::uint64_t kMaximumFile = 0xffffffffu; // what glTF's 32-bit lengths can hold

[[noreturn]] void fail_resource(const std::string& path, const std::string& what) {
    throw InputError(path + ": " + what);
}

/// RFC 4648; white space is passed over, padding may be missing.
std::optional<std::vector<unsigned char>> base64_decoded(std::string_view text) {
    std::array<signed char, 256> value{};
    value.fill(-1);
    const std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (std::size_t i = 0; i < digits.size(); ++i)
        value[static_cast<unsigned char>(digits[i])] = static_cast<signed char>(i);
    value[static_cast<unsigned char>('-')] = 62; // the alphabet for URLs
    value[static_cast<unsigned char>('_')] = 63;
    std::vector<unsigned char> bytes;
    bytes.reserve(text.size() / 4 * 3 + 3);
    std::uint32_t group = 0;
    int bits = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto c = static_cast<unsigned char>(text[i]);
        if (c == '=')
            break;
        if (std::isspace(c))
            continue;
        if (value[c] < 0)
            return std::nullopt;
        group = group << 6 | std::uint32_t(value[c]);
        bits += 6;
        if (bits >= 8) {
            bits -= 8;
            bytes.push_back(static_cast<unsigned char>(group >> bits & 0xff));
        }
    }
    return bytes;
}

/// Where the binary chunk of a .glb begins and how long it is; 0 long if there is none.
std::pair<std::size_t, std::size_t> binary_chunk(std::span<const unsigned char> file) {
    const auto number = [&](std::size_t at) {
        return std::uint64_t(file[at]) | std::uint64_t(file[at + 1]) << 8 | std::uint64_t(file[at + 2]) << 16 |
               std::uint64_t(file[at + 3]) << 24;
    };
    // The first chunk is JSON (checked by parse_gltf_json); those of unknown kinds are passed over.
    std::uint64_t at = 12;
    while (at + 8 <= file.size()) {
        const std::uint64_t length = number(at), kind = number(at + 4);
        if (kind == 0x004e4942) // "BIN"
            return {at + 8, std::size_t(std::min<std::uint64_t>(length, file.size() - at - 8))};
        at += 8 + (length + 3) / 4 * 4;
    }
    return {0, 0};
}

/// Buffers that plain views or compressed data refer to.
std::vector<bool> buffers_in_use(const nlohmann::json& json, std::size_t count) {
    std::vector<bool> used(count, false);
    const auto views = json.find("bufferViews");
    if (views == json.end())
        return used;
    for (const nlohmann::json& view : *views) {
        const nlohmann::json* extension = meshopt_extension(view);
        const nlohmann::json& source = extension ? *extension : view;
        if (const auto buffer = source.find("buffer"); buffer != source.end() && buffer->is_number_unsigned())
            if (const std::uint64_t index = buffer->get<std::uint64_t>(); index < count)
                used[index] = true;
    }
    return used;
}

} // namespace

const nlohmann::json* meshopt_extension(const nlohmann::json& view) {
    const auto extensions = view.find("extensions");
    if (extensions == view.end() || !extensions->is_object())
        return nullptr;
    for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
        if (const auto found = extensions->find(name); found != extensions->end() && found->is_object())
            return &*found;
    return nullptr;
}

bool is_data_uri(const std::string& uri) {
    return uri.starts_with("data:");
}

std::vector<unsigned char> data_uri_bytes(const std::string& uri, const std::string& path, const std::string& place) {
    const std::size_t comma = uri.find(',');
    if (comma == std::string::npos)
        fail_resource(path, place + ": its data URI has no data");
    const std::string_view kind(uri.data(), comma);
    if (!kind.ends_with(";base64")) {
        const std::string text = percent_decoded(uri.substr(comma + 1));
        return {text.begin(), text.end()};
    }
    std::optional<std::vector<unsigned char>> bytes = base64_decoded(std::string_view(uri).substr(comma + 1));
    if (!bytes)
        fail_resource(path, place + ": its data URI is not valid base64");
    return std::move(*bytes);
}

std::vector<std::vector<unsigned char>> read_gltf_buffers(const nlohmann::json& json, std::vector<unsigned char> file,
                                                          bool binary, const std::filesystem::path& path) {
    std::vector<std::vector<unsigned char>> buffers;
    const auto listed = json.find("buffers");
    if (listed == json.end())
        return buffers;
    buffers.resize(listed->size());
    const std::vector<bool> used = buffers_in_use(json, buffers.size());
    for (std::size_t i = 0; i < buffers.size(); ++i) {
        if (!used[i])
            continue;
        const nlohmann::json& buffer = (*listed)[i];
        const std::string place = "buffer " + std::to_string(i);
        const auto uri = buffer.find("uri");
        if (uri == buffer.end()) {
            if (!binary || i > 0)
                fail_resource(path.string(), place + " has no \"uri\"");
            const auto [begin, length] = binary_chunk(file);
            if (length == 0)
                fail_resource(path.string(), "has no binary chunk, where " + place + " should be");
            file.resize(begin + length);
            file.erase(file.begin(), file.begin() + std::ptrdiff_t(begin));
            buffers[i] = std::move(file);
        } else {
            const std::string& name = uri->get_ref<const std::string&>();
            buffers[i] = is_data_uri(name)
                             ? data_uri_bytes(name, path.string(), place)
                             : read_file_bytes(find_named_file(path.parent_path(), name, NameReach::own_folder,
                                                               path.string() + ": " + place),
                                               kMaximumFile);
        }
        const std::uint64_t length = buffer.at("byteLength").get<std::uint64_t>();
        if (buffers[i].size() < length)
            fail_resource(path.string(), place + " is cut off: it should have " + std::to_string(length) +
                                             " bytes and has " + std::to_string(buffers[i].size()));
        buffers[i].resize(std::size_t(length)); // what follows is padding
    }
    return buffers;
}

} // namespace kokage
