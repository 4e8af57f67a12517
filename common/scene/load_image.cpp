#include "common/scene/exr_header.h"
#include "common/scene/image_file.h"
#include "common/scene/image_io.h"
#include "common/scene/png_file.h"
#include "common/services/error.h"
#include "common/services/named_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

namespace kokage {
namespace {

using Input = std::unique_ptr<OIIO::ImageInput>;

[[noreturn]] void fail_to_read(const std::string& name, const std::string& why) {
    throw InputError("cannot read image '" + name + "': " + why);
}

constexpr const char* kUnreadable =
    "it is damaged or of an unknown format; .hdr, .exr, .png, .jpg, .tif, .webp, .bmp and .tga can be read";
constexpr const char* kMending = "; export it, or the file that it belongs to, again";
constexpr std::uint64_t kMaximumPng = 0xffffffffu;

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

void check_pixel_count(std::uint64_t width, std::uint64_t height, const std::string& name, std::uint64_t max_pixels) {
    if (width * height > max_pixels)
        fail_to_read(name, "its " + std::to_string(width) + " x " + std::to_string(height) +
                               " pixels are more than the limit of " + std::to_string(max_pixels) +
                               "; shrink it first");
}

void check_header(const OIIO::ImageSpec& spec, const std::string& name, std::uint64_t max_pixels) {
    if (spec.deep)
        fail_to_read(name, "it is a deep image; flatten it first");
    if (spec.depth > 1)
        fail_to_read(name, "it is a volume; give a flat image");
    if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1)
        fail_to_read(name, "it has no pixels");
    check_pixel_count(std::uint64_t(spec.width), std::uint64_t(spec.height), name, max_pixels);
    check_pixel_count(std::uint64_t(std::max(spec.full_width, 1)), std::uint64_t(std::max(spec.full_height, 1)), name,
                      max_pixels);
}

/// Deflate packs at most 1032 bytes into one (zlib's manual), and a byte holds at most 8 pixels; JPEG stays far below.
/// A header that announces more is damaged, and reading on would take memory and seconds for nothing.
void check_density(int width, int height, const std::string& name, std::uint64_t file_bytes) {
    constexpr std::uint64_t most = 1032 * 8;
    if (std::uint64_t(width) * std::uint64_t(height) > most * (file_bytes + 64))
        fail_to_read(name, "it is damaged: it announces " + std::to_string(width) + " x " + std::to_string(height) +
                               " pixels, more than its " + std::to_string(file_bytes) + " bytes can hold");
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

/// The chosen channels, in their order.
Image read_channels(OIIO::ImageInput& input, const ChannelChoice& choice, const std::string& name,
                    const ImageLoading& loading) {
    const OIIO::ImageSpec& spec = input.spec();
    const auto chosen_end = choice.source.begin() + choice.count;
    const int first = *std::min_element(choice.source.begin(), chosen_end);
    const int last = *std::max_element(choice.source.begin(), chosen_end) + 1;
    const std::size_t count = std::size_t(spec.width) * std::size_t(spec.height), between = std::size_t(last - first);
    if (between * count > std::size_t(4) * loading.max_pixels)
        fail_to_read(name, "its colour channels lie among too many others; write them to a file of their own");
    Image image(spec.width, spec.height, last - first);
    if (!input.read_image(0, 0, first, last, OIIO::TypeDesc::FLOAT, image.pixels.data()))
        fail_to_read(name,
                     "it is damaged (" + one_line(input.geterror(), "its pixels can't be decoded") + ")" + kMending);
    if (choice.count == last - first && std::is_sorted(choice.source.begin(), chosen_end))
        return image;
    Image chosen(image.width, image.height, choice.count);
    for (std::size_t i = 0; i < count; ++i)
        for (int c = 0; c < choice.count; ++c)
            chosen.pixels[i * std::size_t(choice.count) + std::size_t(c)] =
                image.pixels[i * between + std::size_t(choice.source[std::size_t(c)] - first)];
    return chosen;
}

Image read(OIIO::ImageInput& input, const std::string& name, std::uint64_t file_bytes, const ImageLoading& loading) {
    const OIIO::ImageSpec spec = input.spec();
    check_header(spec, name, loading.max_pixels);
    if (std::string_view(input.format_name()) == "jpeg")
        check_density(spec.width, spec.height, name, file_bytes);
    const ChannelChoice choice = choose_channels(spec);
    Image image = to_frame(read_channels(input, choice, name, loading), spec);
    const bool integers = !spec.format.is_floating_point();
    const bool alpha_wanted = loading.channels == 0 || loading.channels == 4;
    if (choice.has_alpha() && alpha_wanted && is_premultiplied(input, spec))
        divide_by_alpha(image, integers);
    if (loading.meaning == PixelMeaning::color && integers)
        decode_srgb(image, choice.has_alpha(), spec.format.size() == 1);
    return convert_channels(std::move(image), loading.channels);
}

Image read_png(std::span<const std::byte> bytes, const std::string& name, const ImageLoading& loading) {
    try {
        PngFile png(bytes);
        check_pixel_count(std::uint64_t(png.width()), std::uint64_t(png.height()), name, loading.max_pixels);
        check_density(png.width(), png.height(), name, bytes.size());
        Image image = png.pixels();
        if (loading.meaning == PixelMeaning::color)
            decode_srgb(image, image.channels % 2 == 0, png.bits() == 8);
        return convert_channels(std::move(image), loading.channels);
    } catch (const PngError& error) {
        fail_to_read(name, error.what() + std::string(kMending));
    }
}

void check_that_it_is_a_file(const std::filesystem::path& path) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored))
        fail_to_read(path.string(), "there is no such file");
    if (std::filesystem::is_directory(path, ignored))
        fail_to_read(path.string(), "it is a folder");
}

/// By its first bytes, whatever it is called.
bool is_png(const std::filesystem::path& path) {
    std::array<char, 4> bytes{};
    std::ifstream file(path, std::ios::binary);
    file.read(bytes.data(), bytes.size());
    return file && image_format(std::as_bytes(std::span(bytes))) == "png";
}

Input open(const std::filesystem::path& path) {
    if (const std::string problem = exr_header_problem(path); !problem.empty())
        fail_to_read(path.string(), "it is damaged: " + problem + kMending);
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
    check_that_it_is_a_file(path);
    if (is_png(path)) {
        const std::vector<unsigned char> bytes = read_file_bytes(path, kMaximumPng);
        return read_png(std::as_bytes(std::span(bytes)), path.string(), loading);
    }
    const Input input = open(path);
    std::error_code ignored;
    const std::uintmax_t size = std::filesystem::file_size(path, ignored);
    return read(*input, path.string(), ignored ? std::uint64_t(1) << 40 : std::uint64_t(size), loading);
}

Image load_image(std::span<const std::byte> bytes, const std::string& name, const ImageLoading& loading) {
    const std::string format = image_format(bytes);
    if (format == "ktx2" || format == "avif")
        fail_to_read(name, "it is a " + std::string(format == "ktx2" ? "KTX2 texture" : "AVIF image") +
                               ", which can't be decoded; convert it to PNG or JPEG");
    if (format.empty())
        fail_to_read(name, "its first bytes are of no known format (PNG, JPEG, WebP, EXR, HDR, TIFF, BMP, GIF, DDS)");
    if (format == "png")
        return read_png(bytes, name, loading);
    if (const std::string problem = exr_header_problem(bytes); !problem.empty())
        fail_to_read(name, "it is damaged: " + problem + kMending);
    use_our_thread_count();
    OIIO::Filesystem::IOMemReader memory(const_cast<std::byte*>(bytes.data()), bytes.size());
    OIIO::ImageSpec config = straight_alpha_request();
    OIIO::Filesystem::IOProxy* proxy = &memory;
    config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy); // the argument alone is lost where a config is given
    const Input input = OIIO::ImageInput::open("memory." + format, &config, proxy);
    if (!input)
        fail_to_read(name, one_line(OIIO::geterror(), kUnreadable));
    return read(*input, name, bytes.size(), loading);
}

ImageHeader image_header(const std::filesystem::path& path) {
    check_that_it_is_a_file(path);
    if (is_png(path)) {
        const std::vector<unsigned char> bytes = read_file_bytes(path, kMaximumPng);
        try {
            const PngFile png(std::as_bytes(std::span(bytes)));
            return {png.width(), png.height(), png.channels(), png.bits(), false};
        } catch (const PngError& error) {
            fail_to_read(path.string(), error.what() + std::string(kMending));
        }
    }
    const OIIO::ImageSpec spec = open(path)->spec();
    return {spec.full_width, spec.full_height, spec.nchannels, int(spec.format.size()) * 8,
            spec.format.is_floating_point()};
}

} // namespace kokage
