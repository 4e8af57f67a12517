// PNGs that OpenImageIO would not write: few bits, interlaced, transparent by colour; and damaged ones, about which
// nothing may be printed but our own line.
#include "common/scene/image_file.h"
#include "common/services/error.h"
#include "tests/support/temporary_folder.h"

#include <cstdint>
#include <fstream>
#include <gtest/gtest.h>

namespace kokage {
namespace {

using Bytes = std::vector<std::byte>;

void append_big_endian(Bytes& bytes, std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8)
        bytes.push_back(std::byte(value >> shift & 255));
}

Bytes bytes_of(std::initializer_list<int> values) {
    Bytes bytes;
    for (const int value : values)
        bytes.push_back(std::byte(value));
    return bytes;
}

/// PNG specification, annex D, bit by bit.
std::uint32_t checksum(const Bytes& bytes, std::size_t from) {
    std::uint32_t value = 0xffffffffu;
    for (std::size_t i = from; i < bytes.size(); ++i) {
        value ^= std::uint32_t(bytes[i]);
        for (int bit = 0; bit < 8; ++bit)
            value = (value & 1) != 0 ? 0xedb88320u ^ value >> 1 : value >> 1;
    }
    return ~value;
}

void append_chunk(Bytes& png, const std::string& type, const Bytes& data) {
    append_big_endian(png, std::uint32_t(data.size()));
    const std::size_t begin = png.size();
    for (const char c : type)
        png.push_back(std::byte(c));
    png.insert(png.end(), data.begin(), data.end());
    append_big_endian(png, checksum(png, begin));
}

/// A zlib stream of one stored block (RFC 1950, RFC 1951 section 3.2.4).
Bytes stored(const Bytes& data) {
    Bytes stream = bytes_of({0x78, 0x01, 0x01, int(data.size()), 0, int(~data.size() & 255), 255});
    stream.insert(stream.end(), data.begin(), data.end());
    std::uint32_t a = 1, b = 0;
    for (const std::byte byte : data) {
        a = (a + std::uint32_t(byte)) % 65521;
        b = (b + a) % 65521;
    }
    append_big_endian(stream, b << 16 | a);
    return stream;
}

struct PngParts {
    int width = 1, height = 1, bits = 8, color_type = 0, interlace = 0;
    Bytes palette{}, transparency{};
    Bytes rows{}; ///< each behind its filter byte
    bool damaged_transparency = false;
};

Bytes png_of(const PngParts& parts) {
    Bytes png = bytes_of({0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'});
    append_chunk(
        png, "IHDR",
        bytes_of({0, 0, 0, parts.width, 0, 0, 0, parts.height, parts.bits, parts.color_type, 0, 0, parts.interlace}));
    if (!parts.palette.empty())
        append_chunk(png, "PLTE", parts.palette);
    if (!parts.transparency.empty())
        append_chunk(png, "tRNS", parts.transparency);
    if (parts.damaged_transparency)
        png.back() ^= std::byte(1);
    append_chunk(png, "IDAT", stored(parts.rows));
    append_chunk(png, "IEND", {});
    return png;
}

Image load_data(const Bytes& png) {
    return load_image(png, "a.png", {.meaning = PixelMeaning::data});
}

/// What is said about a PNG; empty if it is read. Nothing may be printed beside it.
std::string png_complaint(const Bytes& png) {
    std::string what;
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    try {
        load_image(png, "a.png");
    } catch (const InputError& error) {
        what = error.what();
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    return what;
}

Bytes good_png() {
    Image image(40, 30, 3);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        image.pixels[i] = float((i * 37) % 101) / 101.f;
    return encode_png(image);
}

TEST(PngFile, FewBitsAreSpreadOverAll) {
    const Image grey = load_data(png_of({.width = 4, .bits = 2, .rows = bytes_of({0, 0b00011011})}));
    ASSERT_EQ(grey.channels, 1);
    EXPECT_EQ(grey.pixels, (std::vector<float>{0, 85 / 255.f, 170 / 255.f, 1}));
    const Image line = load_data(png_of({.width = 8, .bits = 1, .rows = bytes_of({0, 0b01000001})}));
    EXPECT_EQ(line.pixels, (std::vector<float>{0, 1, 0, 0, 0, 0, 0, 1}));
}

TEST(PngFile, SixteenBitsKeepTheirOrder) {
    const Image image = load_data(png_of({.bits = 16, .color_type = 4, .rows = bytes_of({0, 1, 2, 0xff, 0xfe})}));
    ASSERT_EQ(image.channels, 2);
    EXPECT_EQ(image.pixels, (std::vector<float>{258 / 65535.f, 65534 / 65535.f}));
}

TEST(PngFile, AColorCanBeTransparent) {
    const Image image = load_data(png_of({.width = 2,
                                          .color_type = 2,
                                          .transparency = bytes_of({0, 1, 0, 2, 0, 3}),
                                          .rows = bytes_of({0, 1, 2, 3, 255, 0, 255})}));
    ASSERT_EQ(image.channels, 4);
    EXPECT_EQ(image.pixels, (std::vector<float>{1 / 255.f, 2 / 255.f, 3 / 255.f, 0, 1, 0, 1, 1}));
}

TEST(PngFile, PalettesAreExpanded) {
    const Image image = load_data(png_of({.width = 2,
                                          .bits = 4,
                                          .color_type = 3,
                                          .palette = bytes_of({255, 0, 0, 0, 255, 0}),
                                          .rows = bytes_of({0, 0x10})}));
    ASSERT_EQ(image.channels, 3);
    EXPECT_EQ(image.pixels, (std::vector<float>{0, 1, 0, 1, 0, 0}));
}

/// Adam7: the first pass holds the left pixel, the sixth the right one.
TEST(PngFile, InterlacedPixelsFindTheirPlace) {
    const Image image = load_data(png_of({.width = 2, .interlace = 1, .rows = bytes_of({0, 255, 0, 51})}));
    EXPECT_EQ(image.pixels, (std::vector<float>{1, 51 / 255.f}));
}

TEST(PngFile, DamageIsToldInOneLine) {
    const Bytes good = good_png();
    EXPECT_EQ(png_complaint(good), "");
    Bytes damaged = good;
    damaged[good.size() / 2] ^= std::byte(0x10);
    EXPECT_NE(png_complaint(damaged).find("its pixels are damaged ("), std::string::npos) << png_complaint(damaged);
    EXPECT_NE(png_complaint(damaged).find("; export"), std::string::npos) << png_complaint(damaged);
    for (const std::size_t place : {5, 12, 13, 20}) { // signature, IHDR's type, the width
        damaged = good;
        damaged[place] ^= std::byte(0x20);
        EXPECT_NE(png_complaint(damaged).find("its header is damaged ("), std::string::npos) << png_complaint(damaged);
    }
    for (const std::size_t size : {std::size_t(20), good.size() / 2, good.size() - 12, good.size() - 1})
        EXPECT_NE(png_complaint({good.begin(), good.begin() + std::ptrdiff_t(size)}).find("it is cut off"),
                  std::string::npos)
            << size;
}

/// Checksums that are right around pixels that are not.
TEST(PngFile, WrongPixelsWithRightChecksumsAreToldInOneLine) {
    const auto with_pixels = [](const Bytes& data) {
        Bytes png = png_of({.rows = bytes_of({0, 7})});
        png.resize(8 + 25); // signature and header
        append_chunk(png, "IDAT", data);
        append_chunk(png, "IEND", {});
        return png;
    };
    EXPECT_EQ(png_complaint(with_pixels(stored(bytes_of({0, 7})))), "");
    const std::vector<std::pair<const char*, Bytes>> wrong = {
        {"no stream of zlib's", bytes_of({1, 2, 3, 4, 5})},
        {"a block of no known type", bytes_of({0x78, 0x01, 0x07, 0, 0})},
        {"too few pixels", stored(bytes_of({0}))},
        {"no known filter", stored(bytes_of({9, 7}))},
        {"nothing", {}},
    };
    for (const auto& [what, data] : wrong)
        EXPECT_NE(png_complaint(with_pixels(data)).find("its pixels are damaged ("), std::string::npos)
            << what << ": " << png_complaint(with_pixels(data));
}

TEST(PngFile, WhatPixelsDoNotNeedMayBeDamaged) {
    const Bytes good = good_png();
    Bytes with_more = good; // a text of no length whose checksum is wrong, and a colour profile of no sense
    with_more.insert(with_more.end() - 12, 12, std::byte(0));
    const std::string type = "tEXt";
    for (std::size_t i = 0; i < 4; ++i)
        with_more[with_more.size() - 20 + i] = std::byte(type[i]);
    Bytes profile;
    append_chunk(profile, "iCCP", bytes_of({'x', 0, 0, 1, 2, 3}));
    with_more.insert(with_more.begin() + 33, profile.begin(), profile.end());
    EXPECT_EQ(png_complaint(with_more), "");
    EXPECT_EQ(load_data(with_more).pixels, load_data(good).pixels);
}

/// Without its transparency a leaf would be a whole card.
TEST(PngFile, DamagedTransparencyIsRefused) {
    PngParts parts{.color_type = 2, .transparency = bytes_of({0, 1, 0, 2, 0, 3}), .rows = bytes_of({0, 1, 2, 3})};
    EXPECT_EQ(png_complaint(png_of(parts)), "");
    parts.damaged_transparency = true;
    EXPECT_NE(png_complaint(png_of(parts)).find("its header is damaged (tRNS"), std::string::npos)
        << png_complaint(png_of(parts));
}

TEST(PngFile, IsKnownByItsBytesWhateverItsName) {
    TemporaryFolder folder;
    Bytes png = png_of({.rows = bytes_of({9, 7})}); // OpenImageIO would let libpng print
    std::ofstream(folder / "a.jpg", std::ios::binary)
        .write(reinterpret_cast<const char*>(png.data()), std::streamsize(png.size()));
    testing::internal::CaptureStderr();
    EXPECT_THROW(load_image(folder / "a.jpg"), InputError);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_EQ(image_header(folder / "a.jpg").channels, 1);
}

} // namespace
} // namespace kokage
