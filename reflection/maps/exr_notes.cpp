#include "reflection/maps/exr_notes.h"

#include "common/scene/exr_header.h"
#include "common/scene/image_io.h"
#include "common/services/byte_hash.h"
#include "common/services/error.h"
#include "common/services/output_file.h"

#include <OpenImageIO/imageio.h>
#include <algorithm>
#include <array>
#include <cstring>

namespace kokage {
namespace {

constexpr const char* kPrefix = "kokage:";

[[noreturn]] void fail_to_read(const std::filesystem::path& path, const std::string& why) {
    throw InputError("cannot read map '" + path.string() + "': " + why);
}

[[noreturn]] void fail_to_write(const std::filesystem::path& path, const std::string& why) {
    throw InputError("cannot write map '" + path.string() + "': " + why);
}

/// Of all notes but the checksum itself, then of the pixels.
std::string checksum_of(const ExrNotes& notes, const ExrPixels& pixels) {
    std::string text;
    for (const auto& [key, value] : notes)
        if (key != "checksum")
            text += key + '=' + value + '\n';
    const std::uint64_t sum = byte_hash(std::span(pixels.bytes), byte_hash(std::as_bytes(std::span(text))));
    std::array<char, 17> digits{};
    std::snprintf(digits.data(), digits.size(), "%016llx", static_cast<unsigned long long>(sum));
    return digits.data();
}

std::unique_ptr<OIIO::ImageInput> open(const std::filesystem::path& path) {
    std::error_code error;
    if (!std::filesystem::exists(path, error))
        fail_to_read(path, "there is no such file");
    if (!std::filesystem::is_regular_file(path, error))
        fail_to_read(path, "it is no file");
    if (const std::string problem = exr_header_problem(path); !problem.empty())
        fail_to_read(path, "it is damaged: " + problem + "; bake it again");
    use_our_thread_count();
    auto input = OIIO::ImageInput::create("exr");
    OIIO::ImageSpec spec;
    if (!input || !input->open(path.string(), spec))
        fail_to_read(path, "it is no EXR file, or damaged (" +
                               one_line(input ? input->geterror() : OIIO::geterror(), "its header can't be read") +
                               ")");
    return input;
}

} // namespace

ExrPixels exr_pixels(const Image& image, bool halves) {
    const TexelFormat format = halves ? TexelFormat::half_rgb : TexelFormat::float_rgb;
    const auto* texels = reinterpret_cast<const glm::vec3*>(image.pixels.data());
    static_assert(sizeof(glm::vec3) == 3 * sizeof(float));
    return {image.width, image.height, halves, packed_texels({texels, image.pixels.size() / 3}, format), 0};
}

void write_noted_exr(const std::filesystem::path& path, const ExrPixels& pixels, const ExrNotes& notes,
                     ExrCompression compression) {
    const OIIO::TypeDesc type = pixels.halves ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT;
    OIIO::ImageSpec spec(pixels.width, pixels.height, 3, type);
    spec.tile_width = spec.tile_height = pixels.tile;
    spec.attribute("oiio:ColorSpace", "Linear");
    spec.attribute("DateTime", ""); // else the time of writing: the same map would be other bytes each time
    spec.attribute("compression", compression == ExrCompression::zip   ? "zip"
                                  : compression == ExrCompression::rle ? "rle"
                                                                       : "none");
    for (const auto& [key, value] : notes)
        spec.attribute(kPrefix + key, value);
    spec.attribute(std::string(kPrefix) + "checksum", checksum_of(notes, pixels));
    use_our_thread_count();
    OutputFile file(path);
    const auto output = OIIO::ImageOutput::create("exr");
    constexpr const char* disk = "the system did not take it (is the disk full?)";
    if (!output)
        fail_to_write(path, one_line(OIIO::geterror(), disk));
    if (!output->open(file.temporary_path().string(), spec) || !output->write_image(type, pixels.bytes.data()) ||
        !output->close())
        fail_to_write(path, one_line(output->geterror(), disk));
    file.commit();
}

ExrHeader read_exr_header(const std::filesystem::path& path) {
    const auto input = open(path);
    const OIIO::ImageSpec& spec = input->spec();
    if (spec.deep || spec.depth > 1 || spec.nchannels != 3 || spec.width < 1 || spec.height < 1 || spec.x != 0 ||
        spec.y != 0)
        fail_to_read(path, "it is no plain picture of three channels, as maps are");
    if (spec.tile_width > spec.width || spec.tile_height > spec.height)
        fail_to_read(path, "it is damaged: its tiles of " + std::to_string(spec.tile_width) + " x " +
                               std::to_string(spec.tile_height) + " pixels are larger than itself");
    // Deflate packs at most 1032 bytes into one (zlib's manual), and a channel has 2 bytes a pixel or more: a header
    // that announces more is damaged.
    std::error_code error;
    const std::uint64_t pixels = std::uint64_t(spec.width) * std::uint64_t(spec.height);
    if (pixels * 3 * 2 > 1032 * (std::uint64_t(std::filesystem::file_size(path, error)) + 64))
        fail_to_read(path, "it is cut off: its header announces more pixels than its bytes can hold");
    ExrHeader header{spec.width, spec.height, {}};
    for (const OIIO::ParamValue& attribute : spec.extra_attribs) {
        const std::string name = attribute.name().string();
        if (name.rfind(kPrefix, 0) == 0)
            header.notes[name.substr(std::strlen(kPrefix))] = attribute.get_string();
    }
    return header;
}

Image read_noted_exr(const std::filesystem::path& path, const ExrHeader& header) {
    const auto input = open(path);
    const std::size_t pixels = std::size_t(header.width) * std::size_t(header.height);
    ExrPixels stored{header.width, header.height, input->spec().format == OIIO::TypeDesc::HALF, {}, 0};
    const TexelFormat format = stored.halves ? TexelFormat::half_rgb : TexelFormat::float_rgb;
    stored.bytes.resize(pixels * texel_bytes(format));
    if (!input->read_image(0, 0, 0, 3, stored.halves ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT,
                           stored.bytes.data()))
        fail_to_read(path, "it is damaged or cut off (" + one_line(input->geterror(), "its pixels can't be decoded") +
                               "); bake it again");
    const auto noted = header.notes.find("checksum");
    if (noted == header.notes.end() || noted->second != checksum_of(header.notes, stored))
        fail_to_read(path, "its content is not what was written (the checksum differs); bake it again");
    Image image(header.width, header.height, 3);
    for (std::size_t i = 0; i < pixels; ++i) {
        const glm::vec3 texel = unpacked_texel(stored.bytes.data() + i * texel_bytes(format), format);
        std::copy_n(&texel.x, 3, image.pixels.begin() + std::ptrdiff_t(3 * i));
    }
    return image;
}

} // namespace kokage
