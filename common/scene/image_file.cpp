#include "common/scene/image_file.h"
#include "common/scene/png_chunks.h"
#include "common/services/error.h"
#include "common/services/named_file.h"
#include "common/services/output_file.h"
#include "common/services/parallel.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

namespace kokage {
namespace {

using Input = std::unique_ptr<OIIO::ImageInput>;

[[noreturn]] void fail_to_read(const std::string& name, const std::string& why) {
    throw InputError("cannot read image '" + name + "': " + why);
}

/// What OpenImageIO says, as one line; `otherwise` if it says nothing, or something about itself ("Is it a file format
/// that OpenImageIO doesn't know about?").
std::string one_line(std::string text, const char* otherwise) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    while (!text.empty() && text.back() == ' ')
        text.pop_back();
    const bool useless = text.empty() || text.back() == '?' || text.find("OpenImageIO") != std::string::npos;
    return useless ? otherwise : text;
}
constexpr const char* kUnreadable =
    "it is damaged or of an unknown format; .hdr, .exr, .png, .jpg, .tif, .webp, .bmp and .tga can be read";
constexpr const char* kMending = "; export it, or the file that it belongs to, again";
constexpr std::uint64_t kMaximumPng = 0xffffffffu;
constexpr const char* kUnwritable = "the system did not take it (is the disk full?)";

OIIO::ImageSpec straight_alpha_request() {
    OIIO::ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);
    return config;
}

/// Channels of the file that make grey, grey + alpha, RGB or RGBA.
struct ChannelChoice {
    std::array<int, 4> source{0, 0, 0, 0};
    int count = 0;
    bool has_alpha() const { return count == 2 || count == 4; }
};

/// Looks for R, G, B (also as "layer.R"), else takes the first one to four channels.
ChannelChoice choose_channels(const OIIO::ImageSpec& spec) {
    const int r = spec.channelindex("R"), g = spec.channelindex("G"), b = spec.channelindex("B");
    ChannelChoice choice;
    if (r >= 0 && g >= 0 && b >= 0) {
        choice.source = {r, g, b, spec.alpha_channel};
        choice.count = spec.alpha_channel >= 0 ? 4 : 3;
    } else {
        choice.count = std::min(spec.nchannels, 4);
        choice.source = {0, 1, 2, 3};
        if (choice.count == 2 && spec.alpha_channel != 1)
            choice.count = 1;
        if (choice.count == 4 && spec.alpha_channel != 3)
            choice.count = 3;
    }
    return choice;
}

/// Whether the pixels come with alpha multiplied in: because the format stores them so (EXR), or because the reader
/// does it in spite of our request and says nothing (WebP, in OpenImageIO 2.4; it multiplies the encoded values).
bool is_premultiplied(const OIIO::ImageInput& input, const OIIO::ImageSpec& spec) {
    if (spec.get_int_attribute("oiio:UnassociatedAlpha", 0) != 0)
        return false;
    // These readers obey the request for straight alpha but do not say so in the header that they give.
    const std::string_view format = input.format_name();
    return format != "png" && format != "targa" && format != "bmp" && format != "ico" && format != "gif" &&
           format != "psd";
}

void divide_by_alpha(Image& image, bool integers) {
    const int alpha = image.channels - 1;
    for (std::size_t i = 0; i < image.pixels.size(); i += std::size_t(image.channels)) {
        float* pixel = image.pixels.data() + i;
        const float a = pixel[alpha];
        if (a != 0 && a != 1)
            for (int c = 0; c < alpha; ++c)
                pixel[c] = integers ? std::min(1.f, pixel[c] / a) : pixel[c] / a;
    }
}

void decode_srgb(Image& image, bool has_alpha, bool eight_bits) {
    const int colors = image.channels - (has_alpha ? 1 : 0);
    std::array<float, 256> table{};
    for (int i = 0; i < 256; ++i)
        table[std::size_t(i)] = linear_from_srgb(float(i) / 255.f);
    for (std::size_t i = 0; i < image.pixels.size(); i += std::size_t(image.channels))
        for (int c = 0; c < colors; ++c) {
            float& value = image.pixels[i + std::size_t(c)];
            value = eight_bits ? table[std::size_t(std::clamp(std::lround(value * 255.f), 0l, 255l))]
                               : linear_from_srgb(value);
        }
}

Image convert_channels(Image image, int channels) {
    if (channels == 0 || channels == image.channels)
        return image;
    Image result(image.width, image.height, channels);
    const bool grey = image.channels <= 2, alpha = image.channels == 2 || image.channels == 4;
    const std::size_t count = std::size_t(image.width) * std::size_t(image.height);
    for (std::size_t i = 0; i < count; ++i) {
        const float* from = image.pixels.data() + i * std::size_t(image.channels);
        float* to = result.pixels.data() + i * std::size_t(channels);
        for (int c = 0; c < std::min(channels, 3); ++c)
            to[c] = from[grey ? 0 : c];
        if (channels == 4)
            to[3] = alpha ? from[image.channels - 1] : 1.f;
    }
    return result;
}

void check_header(const OIIO::ImageSpec& spec, const std::string& name, std::uint64_t max_pixels) {
    if (spec.deep)
        fail_to_read(name, "it is a deep image; flatten it first");
    if (spec.depth > 1)
        fail_to_read(name, "it is a volume; give a flat image");
    if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1)
        fail_to_read(name, "it has no pixels");
    const int full_width = std::max(spec.full_width, 1), full_height = std::max(spec.full_height, 1);
    const std::uint64_t pixels = std::max(std::uint64_t(spec.width) * std::uint64_t(spec.height),
                                          std::uint64_t(full_width) * std::uint64_t(full_height));
    if (pixels > max_pixels)
        fail_to_read(name, "its " + std::to_string(spec.width) + " x " + std::to_string(spec.height) +
                               " pixels are more than the limit of " + std::to_string(max_pixels) +
                               "; shrink it first");
}

/// Deflate packs at most 1032 bytes into one (zlib's manual), and a byte holds at most 8 pixels; JPEG stays far below.
/// A header that announces more is damaged, and reading on would take memory and seconds for nothing.
void check_density(const OIIO::ImageInput& input, const OIIO::ImageSpec& spec, const std::string& name,
                   std::uint64_t file_bytes) {
    constexpr std::uint64_t most = 1032 * 8;
    const std::string_view format = input.format_name();
    if ((format == "png" || format == "jpeg") &&
        std::uint64_t(spec.width) * std::uint64_t(spec.height) > most * (file_bytes + 64))
        fail_to_read(name, "it is damaged: it announces " + std::to_string(spec.width) + " x " +
                               std::to_string(spec.height) + " pixels, more than its " + std::to_string(file_bytes) +
                               " bytes can hold");
}

/// An EXR may hold a part of its frame, or more than it: cut and pad to the frame.
Image to_frame(Image image, const OIIO::ImageSpec& spec) {
    const int width = std::max(spec.full_width, 1), height = std::max(spec.full_height, 1);
    if (spec.x == spec.full_x && spec.y == spec.full_y && spec.width == width && spec.height == height)
        return image;
    Image frame(width, height, image.channels);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const int fx = x + spec.x - spec.full_x, fy = y + spec.y - spec.full_y;
            if (fx >= 0 && fx < width && fy >= 0 && fy < height)
                std::copy_n(image.at(x, y), image.channels, frame.at(fx, fy));
        }
    return frame;
}

Image read(Input input, const std::string& name, std::uint64_t file_bytes, const ImageLoading& loading) {
    const OIIO::ImageSpec spec = input->spec();
    check_header(spec, name, loading.max_pixels);
    check_density(*input, spec, name, file_bytes);
    const ChannelChoice choice = choose_channels(spec);
    const int first = *std::min_element(choice.source.begin(), choice.source.begin() + choice.count);
    const int last = *std::max_element(choice.source.begin(), choice.source.begin() + choice.count) + 1;
    const std::size_t count = std::size_t(spec.width) * std::size_t(spec.height),
                      read_channels = std::size_t(last - first);
    if (read_channels * count > std::size_t(4) * loading.max_pixels)
        fail_to_read(name, "its colour channels lie among too many others; write them to a file of their own");
    Image image(spec.width, spec.height, last - first);
    if (!input->read_image(0, 0, first, last, OIIO::TypeDesc::FLOAT, image.pixels.data()))
        fail_to_read(name,
                     "it is damaged (" + one_line(input->geterror(), "its pixels can't be decoded") + ")" + kMending);
    const bool direct =
        choice.count == last - first && std::is_sorted(choice.source.begin(), choice.source.begin() + choice.count);
    if (!direct) {
        Image chosen(image.width, image.height, choice.count);
        for (std::size_t i = 0; i < count; ++i)
            for (int c = 0; c < choice.count; ++c)
                chosen.pixels[i * std::size_t(choice.count) + std::size_t(c)] =
                    image.pixels[i * read_channels + std::size_t(choice.source[std::size_t(c)] - first)];
        image = std::move(chosen);
    }
    image = to_frame(std::move(image), spec);
    const bool integers = !spec.format.is_floating_point();
    const bool alpha_wanted = loading.channels == 0 || loading.channels == 4;
    if (choice.has_alpha() && alpha_wanted && is_premultiplied(*input, spec))
        divide_by_alpha(image, integers);
    if (loading.meaning == PixelMeaning::color && integers)
        decode_srgb(image, choice.has_alpha(), spec.format.size() == 1);
    return convert_channels(std::move(image), loading.channels);
}

void use_our_thread_count() {
    OIIO::attribute("threads", thread_count());
    OIIO::attribute("exr_threads", thread_count());
}

Input open(const std::filesystem::path& path) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored))
        fail_to_read(path.string(), "there is no such file");
    if (std::filesystem::is_directory(path, ignored))
        fail_to_read(path.string(), "it is a folder");
    use_our_thread_count();
    const OIIO::ImageSpec config = straight_alpha_request();
    Input input = OIIO::ImageInput::open(path.string(), &config);
    if (!input)
        fail_to_read(path.string(), one_line(OIIO::geterror(), kUnreadable));
    return input;
}

} // namespace

std::string image_format(std::span<const std::byte> bytes) {
    auto starts = [&](std::string_view magic, std::size_t at = 0) {
        return bytes.size() >= at + magic.size() && std::memcmp(bytes.data() + at, magic.data(), magic.size()) == 0;
    };
    if (starts("\x89PNG"))
        return "png";
    if (starts("\xff\xd8\xff"))
        return "jpg";
    if (starts("RIFF") && starts("WEBP", 8))
        return "webp";
    if (starts("\x76\x2f\x31\x01"))
        return "exr";
    if (starts("#?RADIANCE") || starts("#?RGBE"))
        return "hdr";
    if (starts(std::string_view("II*\0", 4)) || starts(std::string_view("MM\0*", 4)))
        return "tif";
    if (starts("BM"))
        return "bmp";
    if (starts("GIF8"))
        return "gif";
    if (starts("DDS "))
        return "dds";
    if (starts("\xabKTX 20\xbb"))
        return "ktx2";
    if (starts("ftypavif", 4) || starts("ftypavis", 4))
        return "avif";
    return "";
}

Image load_image(const std::filesystem::path& path, const ImageLoading& loading) {
    std::error_code missing;
    if (path.extension() == ".png" && std::filesystem::is_regular_file(path, missing)) {
        const std::vector<unsigned char> bytes = read_file_bytes(path, kMaximumPng);
        return load_image(std::as_bytes(std::span(bytes)), path.string(), loading);
    }
    Input input = open(path);
    std::error_code ignored;
    const std::uintmax_t size = std::filesystem::file_size(path, ignored);
    return read(std::move(input), path.string(), ignored ? std::uint64_t(1) << 40 : std::uint64_t(size), loading);
}

Image load_image(std::span<const std::byte> bytes, const std::string& name, const ImageLoading& loading) {
    const std::string format = image_format(bytes);
    if (format == "ktx2" || format == "avif")
        fail_to_read(name, "it is a " + std::string(format == "ktx2" ? "KTX2 texture" : "AVIF image") +
                               ", which can't be decoded; convert it to PNG or JPEG");
    if (format.empty())
        fail_to_read(name, "its first bytes are of no known format (PNG, JPEG, WebP, EXR, HDR, TIFF, BMP, GIF, DDS)");
    use_our_thread_count();
    std::vector<std::byte> png;
    if (format == "png") {
        std::string why;
        png = essential_png_chunks(bytes, why);
        if (png.empty())
            fail_to_read(name, why + kMending);
        bytes = png;
    }
    OIIO::Filesystem::IOMemReader memory(const_cast<std::byte*>(bytes.data()), bytes.size());
    OIIO::ImageSpec config = straight_alpha_request();
    OIIO::Filesystem::IOProxy* proxy = &memory;
    config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy); // the argument alone is lost where a config is given
    Input input = OIIO::ImageInput::open("memory." + format, &config, proxy);
    if (!input)
        fail_to_read(name, one_line(OIIO::geterror(), kUnreadable));
    return read(std::move(input), name, bytes.size(), loading);
}

ImageHeader image_header(const std::filesystem::path& path) {
    const OIIO::ImageSpec spec = open(path)->spec();
    return {spec.full_width, spec.full_height, spec.nchannels, int(spec.format.size()) * 8,
            spec.format.is_floating_point()};
}

namespace {

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

std::string lower_case_extension(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    return extension;
}

} // namespace

void save_image(const std::filesystem::path& path, const Image& image, const ImageSaving& saving) {
    const std::string name = path.string(), extension = lower_case_extension(path);
    const bool png = extension == ".png", hdr = extension == ".hdr";
    if (!png && !hdr && extension != ".exr")
        fail_to_write(name, "the name must end in .png, .exr or .hdr");
    check_for_saving(image, name, !png && !hdr);
    check_png_bits(name, saving);
    if (hdr && image.channels == 4)
        fail_to_write(name, "HDR holds no alpha; save as .exr");
    use_our_thread_count();
    OutputFile file(path);
    const auto output = OIIO::ImageOutput::create(extension.substr(1));
    if (!output)
        fail_to_write(name, one_line(OIIO::geterror(), kUnwritable));
    bool good;
    if (png) {
        good = output->open(file.temporary_path().string(), png_spec(image, saving)) &&
               write_png_pixels(*output, image, saving);
    } else {
        const Image stored = for_float_format(image, hdr);
        OIIO::ImageSpec spec(stored.width, stored.height, stored.channels, OIIO::TypeDesc::FLOAT);
        spec.attribute("oiio:ColorSpace", "Linear");
        good = output->open(file.temporary_path().string(), spec) &&
               output->write_image(OIIO::TypeDesc::FLOAT, stored.pixels.data());
    }
    if (!good || !output->close())
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

float linear_from_srgb(float value) {
    const float size = std::abs(value);
    return std::copysign(size <= 0.04045f ? size / 12.92f : std::pow((size + 0.055f) / 1.055f, 2.4f), value);
}

float srgb_from_linear(float value) {
    const float size = std::abs(value);
    return std::copysign(size <= 0.0031308f ? size * 12.92f : 1.055f * std::pow(size, 1 / 2.4f) - 0.055f, value);
}

} // namespace kokage
