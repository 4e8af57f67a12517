#include "common/scene/image_file.h"
#include "common/services/error.h"
#include "tests/support/temporary_folder.h"

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>

namespace fs = std::filesystem;
using namespace kokage;

namespace {

/// 2 x 2 palette PNG: row 0 red (opaque) and (0, 188, 0) at alpha 128; row 1 blue at alpha 0 and red. The alpha stands
/// in tRNS.
constexpr std::array<unsigned char, 107> palette_png = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00, 0x00,
    0x00, 0x02, 0x00, 0x00, 0x00, 0x02, 0x08, 0x03, 0x00, 0x00, 0x00, 0x45, 0x68, 0xfd, 0x16, 0x00, 0x00, 0x00,
    0x09, 0x50, 0x4c, 0x54, 0x45, 0xff, 0x00, 0x00, 0x00, 0xbc, 0x00, 0x00, 0x00, 0xff, 0x32, 0x19, 0xef, 0x13,
    0x00, 0x00, 0x00, 0x03, 0x74, 0x52, 0x4e, 0x53, 0xff, 0x80, 0x00, 0x7f, 0x6d, 0x68, 0x78, 0x00, 0x00, 0x00,
    0x0e, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0x60, 0x60, 0x64, 0x60, 0x62, 0x00, 0x00, 0x00, 0x0e, 0x00,
    0x04, 0xdb, 0xe0, 0x32, 0x8e, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};

/// A PNG whose header says 1,000,000 x 1,000,000 RGBA, with next to no data.
constexpr std::array<unsigned char, 69> huge_png = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00, 0x0f,
    0x42, 0x40, 0x00, 0x0f, 0x42, 0x40, 0x08, 0x06, 0x00, 0x00, 0x00, 0x5c, 0x6d, 0x38, 0x7d, 0x00, 0x00, 0x00,
    0x0c, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0x60, 0xa0, 0x3d, 0x00, 0x00, 0x00, 0x64, 0x00, 0x01, 0xb8,
    0x99, 0xef, 0x99, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};

/// A lossless 8 x 8 WebP, all (204, 102, 51) at alpha 128.
constexpr std::array<unsigned char, 38> alpha_webp = {
    0x52, 0x49, 0x46, 0x46, 0x1e, 0x00, 0x00, 0x00, 0x57, 0x45, 0x42, 0x50, 0x56, 0x50, 0x38, 0x4c, 0x11, 0x00, 0x00,
    0x00, 0x2f, 0x07, 0xc0, 0x01, 0x10, 0x07, 0x50, 0xb3, 0x32, 0x77, 0xa6, 0x80, 0x81, 0x88, 0xe8, 0x7f, 0x00, 0x00};

class ImageFileTest : public ::testing::Test {
  protected:
    TemporaryFolder temporary;
    const fs::path folder = temporary.path();
};

Image gradient(int width, int height, int channels) {
    Image image(width, height, channels);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        image.pixels[i] = 0.05f + 0.9f * float((i * 37) % 101) / 101.f;
    return image;
}

std::vector<std::byte> bytes_of(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    std::vector<char> chars((std::istreambuf_iterator<char>(in)), {});
    std::vector<std::byte> bytes(chars.size());
    std::transform(chars.begin(), chars.end(), bytes.begin(), [](char c) { return std::byte(c); });
    return bytes;
}

float largest_difference(const Image& a, const Image& b) {
    EXPECT_EQ(a.width, b.width);
    EXPECT_EQ(a.height, b.height);
    EXPECT_EQ(a.channels, b.channels);
    float largest = 0;
    for (std::size_t i = 0; i < std::min(a.pixels.size(), b.pixels.size()); ++i)
        largest = std::max(largest, std::abs(a.pixels[i] - b.pixels[i]));
    return largest;
}

TEST_F(ImageFileTest, SrgbCurveInvertsAndMeetsKnownValues) {
    EXPECT_NEAR(linear_from_srgb(0.5f), 0.21404114f, 1e-6f); // IEC 61966-2-1
    EXPECT_NEAR(linear_from_srgb(188.f / 255.f), 0.50288656f, 1e-6f);
    for (float x = -0.5f; x < 2.f; x += 0.01f)
        EXPECT_NEAR(srgb_from_linear(linear_from_srgb(x)), x, 2e-6f);
}

TEST_F(ImageFileTest, EveryFormatComesBackFromPathAndFromMemory) {
    for (const char* extension : {".png", ".exr", ".hdr"})
        for (int channels : {1, 3, 4}) {
            if (std::string(extension) == ".hdr" && channels == 4)
                continue;
            const Image image = gradient(13, 7, channels);
            const fs::path path = folder / (std::string("image") + extension);
            save_image(path, image);
            // Half a step of 255 on the steepest part of the decoded curve; RGBE keeps 8 bits of mantissa.
            const float tolerance = std::string(extension) == ".exr" ? 1e-6f : 5e-3f;
            const int wanted = std::string(extension) == ".hdr" ? channels : 0;
            const Image from_path = load_image(path, {.channels = wanted});
            EXPECT_LE(largest_difference(from_path, image), tolerance) << extension << " " << channels;
            const Image from_memory = load_image(bytes_of(path), "memory", {.channels = wanted});
            EXPECT_EQ(largest_difference(from_memory, from_path), 0) << extension << " " << channels;
            const ImageHeader size = image_header(path);
            EXPECT_EQ(size.width, 13);
            EXPECT_EQ(size.height, 7);
            EXPECT_EQ(size.is_linear, std::string(extension) != ".png");
            EXPECT_EQ(size.bits, std::string(extension) == ".png" ? 8 : 32);
        }
}

TEST_F(ImageFileTest, SixteenBitPngIsDecodedFromSrgbAndFinelyStepped) {
    const Image image = gradient(40, 9, 3);
    save_image(folder / "a.png", image, {.png_bits = 16});
    EXPECT_LE(largest_difference(load_image(folder / "a.png"), image), 3e-5f);
}

TEST_F(ImageFileTest, DataIsNotDecoded) {
    const Image image = gradient(9, 9, 3);
    save_image(folder / "a.png", image, {.png_encoding = PngEncoding::as_is});
    EXPECT_LE(largest_difference(load_image(folder / "a.png", {.meaning = PixelMeaning::data}), image),
              0.5f / 255.f + 1e-6f);
}

TEST_F(ImageFileTest, PaletteWithTransparencyExpandsToStraightAlpha) {
    const Image image = load_image(std::as_bytes(std::span(palette_png)), "palette");
    ASSERT_EQ(image.channels, 4);
    ASSERT_EQ(image.width, 2);
    auto expect_pixel = [&](int x, int y, std::array<float, 4> wanted) {
        for (int c = 0; c < 4; ++c)
            EXPECT_NEAR(image.at(x, y)[c], wanted[std::size_t(c)], 1e-5f) << x << "," << y << " channel " << c;
    };
    expect_pixel(0, 0, {1, 0, 0, 1});
    expect_pixel(1, 0, {0, linear_from_srgb(188.f / 255.f), 0, 128.f / 255.f});
    expect_pixel(0, 1, {0, 0, 1, 0}); // the colour survives where alpha is 0
    expect_pixel(1, 1, {1, 0, 0, 1});
}

TEST_F(ImageFileTest, AlphaStaysStraightThroughPremultipliedExr) {
    Image image(2, 1, 4);
    image.pixels = {0.8f, 0.4f, 0.2f, 0.5f, 3.f, 2.f, 1.f, 1.f};
    save_image(folder / "a.exr", image);
    EXPECT_LE(largest_difference(load_image(folder / "a.exr"), image), 1e-6f);
    // As a light source the stored, premultiplied values count.
    EXPECT_NEAR(load_image(folder / "a.exr", {.channels = 3}).pixels[0], 0.4f, 1e-6f);
}

TEST_F(ImageFileTest, AlphaOfWebpComesOutStraight) {
    const Image image = load_image(std::as_bytes(std::span(alpha_webp)), "alpha.webp", {.meaning = PixelMeaning::data});
    ASSERT_EQ(image.channels, 4);
    for (std::size_t i = 0; i < image.pixels.size(); i += 4) {
        EXPECT_NEAR(image.pixels[i], 0.8f, 0.01f); // the reader rounds after multiplying
        EXPECT_NEAR(image.pixels[i + 1], 0.4f, 0.01f);
        EXPECT_NEAR(image.pixels[i + 2], 0.2f, 0.01f);
        EXPECT_NEAR(image.pixels[i + 3], 128 / 255.f, 1e-6f);
    }
}

TEST_F(ImageFileTest, ConvertsChannels) {
    save_image(folder / "grey.png", gradient(3, 2, 1));
    const Image grey = load_image(folder / "grey.png"), rgba = load_image(folder / "grey.png", {.channels = 4});
    ASSERT_EQ(grey.channels, 1);
    ASSERT_EQ(rgba.channels, 4);
    for (int x = 0; x < 3; ++x) {
        EXPECT_EQ(rgba.at(x, 1)[0], grey.at(x, 1)[0]);
        EXPECT_EQ(rgba.at(x, 1)[2], grey.at(x, 1)[0]);
        EXPECT_EQ(rgba.at(x, 1)[3], 1.f);
    }
    save_image(folder / "rgba.png", gradient(3, 2, 4));
    EXPECT_EQ(load_image(folder / "rgba.png", {.channels = 3}).channels, 3);
    EXPECT_EQ(load_image(folder / "rgba.png", {.channels = 1}).channels, 1);
}

TEST_F(ImageFileTest, RefusesTooLargeImagesByTheirHeader) {
    try {
        load_image(std::as_bytes(std::span(huge_png)), "huge.png");
        FAIL() << "accepted";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("huge.png"), std::string::npos);
        EXPECT_NE(std::string(error.what()).find("1000000"), std::string::npos) << error.what();
    }
    save_image(folder / "a.exr", gradient(10, 10, 3));
    EXPECT_THROW(load_image(folder / "a.exr", {.max_pixels = 99}), InputError);
    EXPECT_NO_THROW(load_image(folder / "a.exr", {.max_pixels = 100}));
}

TEST_F(ImageFileTest, RefusesPngsThatAnnounceMoreThanTheyCanHold) {
    std::vector<std::byte> png = encode_png(gradient(8, 8, 3));
    png[18] = std::byte(0x20);              // 8,200 wide
    png[22] = std::byte(0x1f);              // 7,944 high
    const std::uint32_t check = 0x5c674a2c; // the CRC of the changed header (RFC 2083)
    for (std::size_t i = 0; i < 4; ++i)
        png[29 + i] = std::byte(check >> (24 - 8 * i) & 255);
    try {
        load_image(png, "small");
        FAIL() << "65 million pixels were read from a few bytes";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("8200 x 7944 pixels, more than its"), std::string::npos)
            << error.what();
    }
    // A plain image packs best of all: it is read.
    const Image plain(2048, 2048, 1);
    EXPECT_EQ(load_image(encode_png(plain), "plain").width, 2048);
}

TEST_F(ImageFileTest, RefusesWhatIsNoImage) {
    EXPECT_THROW(load_image(folder / "missing.png"), InputError);
    EXPECT_THROW(load_image(folder), InputError);
    std::ofstream(folder / "text.png") << "no image at all";
    std::ofstream(folder / "text.txt") << "no image at all";
    for (const char* name : {"text.png", "text.txt"})
        try {
            load_image(folder / name);
            FAIL() << name;
        } catch (const InputError& error) {
            const std::string what = error.what();
            EXPECT_NE(what.find(name), std::string::npos) << what;
            EXPECT_EQ(what.find('?'), std::string::npos) << what;
            EXPECT_EQ(what.find("OpenImageIO"), std::string::npos) << what;
        }
    EXPECT_THROW(load_image(std::span<const std::byte>(), "empty"), InputError);
    const std::string ktx = "\xabKTX 20\xbb\r\n\x1a\n and more";
    EXPECT_THROW(load_image(std::as_bytes(std::span(ktx)), "texture.ktx2"), InputError);
}

TEST_F(ImageFileTest, RefusesTruncatedFiles) {
    for (const char* extension : {".png", ".exr", ".hdr"}) {
        const fs::path path = folder / (std::string("image") + extension);
        save_image(path, gradient(64, 64, 3));
        std::vector<std::byte> bytes = bytes_of(path);
        bytes.resize(bytes.size() / 2);
        EXPECT_THROW(load_image(bytes, "truncated"), InputError) << extension;
        fs::resize_file(path, bytes.size());
        EXPECT_THROW(load_image(path), InputError) << extension;
    }
}

TEST_F(ImageFileTest, KeepsHugeAndNonFiniteValuesOfExr) {
    Image image(2, 1, 3);
    image.pixels = {1e30f, 1e-30f, 0.f, std::numeric_limits<float>::infinity(), -1.f, 2.f};
    save_image(folder / "a.exr", image);
    const Image back = load_image(folder / "a.exr");
    EXPECT_EQ(back.pixels, image.pixels);
}

TEST_F(ImageFileTest, RefusesToSaveNonFiniteValuesWithTheirPlace) {
    Image image = gradient(5, 4, 3);
    image.at(3, 2)[1] = std::numeric_limits<float>::quiet_NaN();
    for (const char* name : {"a.png", "a.exr", "a.hdr"})
        try {
            save_image(folder / name, image);
            ADD_FAILURE() << name;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find("(3, 2)"), std::string::npos) << error.what();
        }
    EXPECT_TRUE(fs::is_empty(folder));
    EXPECT_THROW(save_image(folder / "a.jpg", gradient(2, 2, 3)), InputError);
    EXPECT_THROW(save_image(folder / "a.hdr", gradient(2, 2, 4)), InputError);
    EXPECT_THROW(save_image(folder / "a.exr", Image()), InputError);
    EXPECT_THROW(save_image(folder / "missing" / "a.exr", gradient(2, 2, 3)), InputError);
}

TEST_F(ImageFileTest, EncodesPngInMemory) {
    const Image image = gradient(6, 5, 4);
    EXPECT_LE(largest_difference(load_image(encode_png(image), "memory"), image), 5e-3f);
}

TEST_F(ImageFileTest, OpensEveryRealTexture) {
    const char* data = std::getenv("KOKAGE_DATA");
    if (!data)
        GTEST_SKIP() << "skipped: KOKAGE_DATA names no folder of real data";
    int count = 0;
    for (const auto& entry : fs::directory_iterator(fs::path(data) / "textures")) {
        const Image image = load_image(entry.path()),
                    from_memory = load_image(bytes_of(entry.path()), entry.path().string());
        EXPECT_EQ(image.pixels, from_memory.pixels) << entry.path();
        ++count;
        if (entry.path().filename() == "leaf_oak.png") {
            ASSERT_EQ(image.channels, 4); // palette + tRNS
            std::size_t clear = 0;
            for (std::size_t i = 3; i < image.pixels.size(); i += 4)
                clear += image.pixels[i] == 0;
            EXPECT_GT(double(clear) / (double(image.width) * image.height), 0.5);
        }
    }
    EXPECT_GE(count, 10);
}

} // namespace
