#pragma once
// Image files through libpng and OpenImageIO: whatever they read (PNG, JPEG, EXR, HDR, WebP, TIFF, TGA, BMP, ...) as
// floats.
#include "common/scene/image.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace kokage {

/// What the numbers of a file mean.
enum class PixelMeaning {
    color, ///< integer files (8 or 16 bit) hold sRGB and are decoded to linear; float files (EXR, HDR) are linear
           ///< already. Alpha is never decoded
    data,  ///< numbers as stored, integers as 0..1: normals, heights, roughness, masks
};

struct ImageLoading {
    PixelMeaning meaning = PixelMeaning::color;
    /// 0: as stored (1 grey, 2 grey + alpha, 3 RGB, 4 RGBA; further channels are left out). 1, 3 or 4: converted: grey
    /// is repeated, missing alpha is 1, superfluous alpha is dropped; colour to 1 channel takes the first. Palettes are
    /// always expanded, tRNS gives alpha.
    int channels = 0;
    /// Refused beyond this, judged by the file's header before memory is taken.
    std::uint64_t max_pixels = std::uint64_t(1) << 28;
};

/// The format of a file's bytes, by the first of them: "png", "jpg", "webp", "exr", "hdr", "tif", "bmp", "gif", "dds",
/// which can be read, "ktx2" or "avif", which can't; "" if unknown.
std::string image_format(std::span<const std::byte> bytes);

/// Loads the first image of a file. Alpha comes out straight, also from formats that store it premultiplied (EXR);
/// where alpha is 0, or when alpha is dropped, the stored colour is kept. Non-finite values are passed on. Throws
/// InputError with the path.
Image load_image(const std::filesystem::path& path, const ImageLoading& loading = {});

/// The same from a file's bytes (an image embedded in a glTF buffer). The format is found by its first bytes; `name` is
/// for messages.
Image load_image(std::span<const std::byte> bytes, const std::string& name, const ImageLoading& loading = {});

struct ImageHeader {
    int width = 0, height = 0, channels = 0;
    int bits = 0;           ///< of a channel, as they are read (.hdr: 32)
    bool is_linear = false; ///< float files hold linear radiance, integer files sRGB
};
/// Reads a file's header alone.
ImageHeader image_header(const std::filesystem::path& path);

/// How linear colour is stored in integer files; EXR and HDR are always written as they are.
enum class PngEncoding {
    srgb_from_linear, ///< for linear colour
    as_is,            ///< for values that are display-ready, or data
};

struct ImageSaving {
    PngEncoding png_encoding = PngEncoding::srgb_from_linear;
    int png_bits = 8; ///< 8 or 16
};

/// Saves as .png (clamped to [0,1]), .exr (32-bit float, alpha multiplied in as the format asks) or .hdr (RGBE:
/// negative values become 0; 1 or 3 channels), whole or not at all (OutputFile). The image has 1, 3 or 4 channels. NaN,
/// and infinity except in .exr, are refused with their place.
void save_image(const std::filesystem::path& path, const Image& image, const ImageSaving& saving = {});

/// A PNG file's bytes, to embed.
std::vector<std::byte> encode_png(const Image& image, const ImageSaving& saving = {});

/// While one lives, an image file is read or written by the thread that asks, without help: for many small files in
/// turn, where handing parts of them to other threads costs more than it saves. Process-wide.
class ImageFilesOnOneThread {
  public:
    ImageFilesOnOneThread();
    ~ImageFilesOnOneThread();
    ImageFilesOnOneThread(const ImageFilesOnOneThread&) = delete;
    ImageFilesOnOneThread& operator=(const ImageFilesOnOneThread&) = delete;
};

/// The sRGB transfer curve, IEC 61966-2-1. Values outside [0,1] are extended along the curve; negative values keep
/// their sign.
float linear_from_srgb(float value);
float srgb_from_linear(float value);

} // namespace kokage
