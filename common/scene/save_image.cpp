#include "common/scene/image_file.h"
#include "common/scene/image_io.h"
#include "common/services/error.h"
#include "common/services/named_file.h"
#include "common/services/output_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <algorithm>
#include <cmath>
#include <cstring>

namespace kokage {
namespace {

constexpr const char* kUnwritable = "the system did not take it (is the disk full?)";

[[noreturn]] void fail_to_write(const std::string& name, const std::string& why) {
    throw InputError("cannot write image '" + name + "': " + why);
}

void check_for_saving(const Image& image, const std::string& name, bool infinity_allowed) {
    if (image.empty() || (image.channels != 1 && image.channels != 3 && image.channels != 4))
        fail_to_write(name,
                      "it is empty or has " + std::to_string(image.channels) + " channels; 1, 3 or 4 can be saved");
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const float value = image.pixels[i];
        if (std::isnan(value) || (std::isinf(value) && !infinity_allowed)) {
            const std::size_t pixel = i / std::size_t(image.channels);
            fail_to_write(name, "pixel (" + std::to_string(pixel % std::size_t(image.width)) + ", " +
                                    std::to_string(pixel / std::size_t(image.width)) + ") is " + std::to_string(value));
        }
    }
}

/// Pixels as 16-bit integers in [0, 2^bits - 1], rounded to nearest.
std::vector<std::uint16_t> quantise(const Image& image, const ImageSaving& saving) {
    std::vector<std::uint16_t> values(image.pixels.size());
    const float top = saving.png_bits == 16 ? 65535.f : 255.f;
    for (std::size_t i = 0; i < values.size(); ++i) {
        float value = std::clamp(image.pixels[i], 0.f, 1.f);
        const bool alpha = image.channels == 4 && i % 4 == 3;
        if (saving.png_encoding == PngEncoding::srgb_from_linear && !alpha)
            value = srgb_from_linear(value);
        values[i] = std::uint16_t(std::lround(value * top));
    }
    return values;
}

OIIO::ImageSpec png_spec(const Image& image, const ImageSaving& saving) {
    OIIO::ImageSpec spec(image.width, image.height, image.channels,
                         saving.png_bits == 16 ? OIIO::TypeDesc::UINT16 : OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:UnassociatedAlpha", 1);
    if (saving.png_encoding == PngEncoding::srgb_from_linear)
        spec.attribute("oiio:ColorSpace", "sRGB");
    return spec;
}

bool write_png_pixels(OIIO::ImageOutput& output, const Image& image, const ImageSaving& saving) {
    const std::vector<std::uint16_t> values = quantise(image, saving);
    if (saving.png_bits == 16)
        return output.write_image(OIIO::TypeDesc::UINT16, values.data());
    const std::vector<std::uint8_t> bytes(values.begin(), values.end());
    return output.write_image(OIIO::TypeDesc::UINT8, bytes.data());
}

void check_png_bits(const std::string& name, const ImageSaving& saving) {
    if (saving.png_bits != 8 && saving.png_bits != 16)
        fail_to_write(name, "PNG has 8 or 16 bits, not " + std::to_string(saving.png_bits));
}

Image for_float_format(const Image& image, bool rgbe) {
    Image result = image;
    if (rgbe)
        for (float& value : result.pixels)
            value = std::max(value, 0.f);
    if (image.channels == 4)
        for (std::size_t i = 0; i < result.pixels.size(); i += 4)
            for (std::size_t c = 0; c < 3; ++c)
                result.pixels[i + c] *= result.pixels[i + 3];
    return rgbe ? convert_channels(std::move(result), 3) : result;
}

} // namespace

void save_image(const std::filesystem::path& path, const Image& image, const ImageSaving& saving) {
    const std::string name = path.string(), extension = lower_ending(path);
    const bool png = extension == ".png", hdr = extension == ".hdr";
    if (!png && !hdr && extension != ".exr")
        fail_to_write(name, "the name must end in .png, .exr or .hdr");
    check_for_saving(image, name, !png && !hdr);
    check_png_bits(name, saving);
    if (hdr && image.channels == 4)
        fail_to_write(name, "HDR holds no alpha; save as .exr");
    use_our_thread_count();
    OutputFile file(path);
    if (png) { // the library does not tell of a full disk
        file.write(encode_png(image, saving));
        return file.commit();
    }
    const auto output = OIIO::ImageOutput::create(extension.substr(1));
    if (!output)
        fail_to_write(name, one_line(OIIO::geterror(), kUnwritable));
    const Image stored = for_float_format(image, hdr);
    OIIO::ImageSpec spec(stored.width, stored.height, stored.channels, OIIO::TypeDesc::FLOAT);
    spec.attribute("oiio:ColorSpace", "Linear");
    spec.attribute("DateTime", ""); // else the time of writing: the same picture would be other bytes each time
    if (!output->open(file.temporary_path().string(), spec) ||
        !output->write_image(OIIO::TypeDesc::FLOAT, stored.pixels.data()) || !output->close())
        fail_to_write(name, one_line(output->geterror(), kUnwritable));
    file.commit();
}

std::vector<std::byte> encode_png(const Image& image, const ImageSaving& saving) {
    const std::string name = "embedded PNG";
    check_for_saving(image, name, false);
    check_png_bits(name, saving);
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    const auto output = OIIO::ImageOutput::create("memory.png", &memory);
    if (!output || !output->open("memory.png", png_spec(image, saving)) || !write_png_pixels(*output, image, saving) ||
        !output->close())
        fail_to_write(name, one_line(output ? output->geterror() : OIIO::geterror(), kUnwritable));
    std::vector<std::byte> result(bytes.size());
    std::memcpy(result.data(), bytes.data(), bytes.size());
    return result;
}

} // namespace kokage
