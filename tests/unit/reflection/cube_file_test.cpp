#include "common/services/error.h"
#include "reflection/maps/cube_file.h"
#include "reflection/maps/texel_codes.h"
#include "tests/support/cube_maps.h"
#include "tests/support/node.h"
#include "tests/support/temporary_folder.h"

#include <cstring>
#include <gtest/gtest.h>
#include <map>

namespace kokage {
namespace {

constexpr TexelFormat kFormats[] = {TexelFormat::half_rgb, TexelFormat::float_rgb, TexelFormat::shared_exponent};

PrefilteredCube filtered_cube() {
    return smooth_cube({.size = 16, .parameters = {0, 0.134, 0.5, 1}});
}

/// What a file's bits keep of a value up to 2.05.
float precision_of(TexelFormat format) {
    return format == TexelFormat::float_rgb ? 0 : format == TexelFormat::half_rgb ? 0.001f : 0.004001f;
}

void expect_same(const CubeFile& file, const PrefilteredCube& cube, TexelFormat format) {
    EXPECT_EQ(file.format, format);
    EXPECT_EQ(file.cube.kind, cube.kind);
    EXPECT_TRUE(file.lobes_known);
    ASSERT_EQ(file.cube.levels.size(), cube.levels.size());
    for (std::size_t i = 0; i < cube.levels.size(); ++i) {
        const PrefilteredCube::Level &read = file.cube.levels[i], &wrote = cube.levels[i];
        EXPECT_EQ(read.size, wrote.size);
        EXPECT_FLOAT_EQ(float(read.parameter), float(wrote.parameter));
        EXPECT_EQ(read.unfiltered, wrote.unfiltered);
        ASSERT_EQ(read.texels.size(), wrote.texels.size());
        for (std::size_t t = 0; t < wrote.texels.size(); ++t)
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(read.texels[t][c], wrote.texels[t][c], precision_of(format)) << "level " << i;
    }
}

TEST(CubeFile, Ktx2ReadsBackWhatWasWritten) {
    TemporaryFolder folder;
    for (const TexelFormat format : kFormats)
        for (const CubeSettings& settings :
             {CubeSettings{.size = 16, .parameters = {0, 0.134, 0.5, 1}}, CubeSettings{.size = 7, .parameters = {0.3}},
              CubeSettings{.size = 1, .parameters = {0}},
              CubeSettings{.size = 8, .kind = LobeKind::phong, .parameters = {HUGE_VAL, 1234.5678, 0}},
              CubeSettings{.size = 512, .parameters = even_roughness(10)}}) {
            const PrefilteredCube cube = smooth_cube(settings);
            const CubeFileSummary summary = write_ktx2(folder / "a.ktx2", cube, format);
            EXPECT_EQ(summary.bytes, std::filesystem::file_size(folder / "a.ktx2"));
            EXPECT_EQ(summary.clamped_texels, 0u);
            const CubeFile file = read_ktx2(folder / "a.ktx2");
            expect_same(file, cube, format);
            EXPECT_TRUE(file.writer.starts_with("kokage "));
            for (std::size_t i = 0; i < cube.levels.size(); ++i) // to the last bit
                EXPECT_EQ(file.cube.levels[i].parameter, cube.levels[i].parameter);
        }
}

TEST(CubeFile, DdsReadsBackWhatWasWritten) {
    TemporaryFolder folder;
    for (const TexelFormat format : {TexelFormat::half_rgb, TexelFormat::float_rgb})
        for (const CubeSettings& settings :
             {CubeSettings{.size = 16, .parameters = {0, 0.134, 0.5, 1}}, CubeSettings{.size = 7, .parameters = {0.3}},
              CubeSettings{.size = 8, .kind = LobeKind::phong, .parameters = {HUGE_VAL, 1234.5678, 0}},
              CubeSettings{.size = 256, .parameters = even_roughness(8)}}) {
            const PrefilteredCube cube = smooth_cube(settings);
            const CubeFileSummary summary = write_dds(folder / "a.dds", cube, format);
            EXPECT_EQ(summary.bytes, std::filesystem::file_size(folder / "a.dds"));
            expect_same(read_dds(folder / "a.dds"), cube, format);
        }
}

TEST(CubeFile, WhatAFormatCannotHoldIsCountedOrRefused) {
    TemporaryFolder folder;
    PrefilteredCube cube = filtered_cube();
    cube.levels[0].texels[5] = {1e6f, 0, 0};
    cube.levels[1].texels[7] = {-1, 2, 3};
    EXPECT_EQ(write_ktx2(folder / "a.ktx2", cube, TexelFormat::half_rgb).clamped_texels, 1u);
    EXPECT_EQ(read_ktx2(folder / "a.ktx2").cube.levels[0].texels[5].r, kLargestHalf);
    EXPECT_EQ(read_ktx2(folder / "a.ktx2").cube.levels[1].texels[7].r, -1);
    EXPECT_EQ(write_ktx2(folder / "a.ktx2", cube, TexelFormat::shared_exponent).clamped_texels, 2u);
    EXPECT_EQ(write_ktx2(folder / "a.ktx2", cube, TexelFormat::float_rgb).clamped_texels, 0u);
    EXPECT_EQ(read_ktx2(folder / "a.ktx2").cube.levels[0].texels[5].r, 1e6f);
    EXPECT_EQ(write_dds(folder / "a.dds", cube, TexelFormat::half_rgb).clamped_texels, 1u);

    auto expect_refused = [](const std::function<void()>& action, const std::string& words) {
        try {
            action();
            ADD_FAILURE() << words;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
        }
    };
    const std::string before = read_text(folder / "a.ktx2");
    cube.levels[2].texels[16 + 6].g = NAN;
    expect_refused([&] { write_ktx2(folder / "a.ktx2", cube, TexelFormat::half_rgb); },
                   "level 2, face -X, texel (2, 1) is not finite");
    expect_refused([&] { write_dds(folder / "a.dds", cube, TexelFormat::half_rgb); }, "not finite");
    EXPECT_EQ(read_text(folder / "a.ktx2"), before);
    expect_refused([&] { write_dds(folder / "a.dds", filtered_cube(), TexelFormat::shared_exponent); }, "take .ktx2");
    expect_refused(
        [&] {
            write_dds(folder / "a.dds", smooth_cube({.size = 256, .parameters = even_roughness(9)}),
                      TexelFormat::half_rgb);
        },
        "room for the roughness of 8 levels, not of 9");
    expect_refused([&] { write_ktx2(folder / "no/such/a.ktx2", filtered_cube(), TexelFormat::half_rgb); }, "no folder");
}

std::string bytes_from_base64(const std::string& text) {
    std::string bytes;
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : text) {
        const std::size_t value =
            std::string_view("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/").find(c);
        if (value == std::string_view::npos)
            break;
        bits = bits << 6 | std::uint32_t(value);
        if ((count += 6) >= 8)
            bytes += char(bits >> (count -= 8) & 255u);
    }
    return bytes;
}

/// ktx-parse gives the values of keys that it does not know as bytes: {"0": 103, "1": 120, ...}, with the final NUL.
std::string text_of(const nlohmann::json& bytes) {
    std::string text;
    for (std::size_t i = 0; i + 1 < bytes.size(); ++i)
        text += char(bytes[std::to_string(i)].get<int>());
    return text;
}

TEST(CubeFile, KtxParseReadsTheSame) {
    const std::string modules = node_modules_with("three");
    if (modules.empty())
        GTEST_SKIP() << "skipped: the npm package three is missing (.ci/setup tests)";
    TemporaryFolder folder;
    const PrefilteredCube cube = filtered_cube();
    std::vector<std::string> arguments = {modules};
    for (const TexelFormat format : kFormats) {
        arguments.push_back(folder / (std::string(texel_format_name(format)) + ".ktx2"));
        write_ktx2(arguments.back(), cube, format);
    }
    const nlohmann::json all = run_node("ktx_parse.js", arguments);
    ASSERT_EQ(all.size(), 3u);
    const std::map<TexelFormat, std::pair<int, int>> vk_format_and_bytes = {{TexelFormat::half_rgb, {97, 8}},
                                                                            {TexelFormat::float_rgb, {109, 16}},
                                                                            {TexelFormat::shared_exponent, {123, 4}}};
    for (std::size_t f = 0; f < 3; ++f) {
        const nlohmann::json& file = all[f];
        const auto [vk_format, texel_bytes_there] = vk_format_and_bytes.at(kFormats[f]);
        EXPECT_EQ(file["vkFormat"], vk_format);
        EXPECT_EQ(file["typeSize"], kFormats[f] == TexelFormat::half_rgb ? 2 : 4);
        EXPECT_EQ(file["pixelWidth"], 16);
        EXPECT_EQ(file["pixelHeight"], 16);
        EXPECT_EQ(file["pixelDepth"], 0);
        EXPECT_EQ(file["layerCount"], 0);
        EXPECT_EQ(file["faceCount"], 6);
        EXPECT_EQ(file["levelCount"], 4);
        EXPECT_EQ(file["supercompressionScheme"], 0);
        EXPECT_EQ(file["keyValue"]["KTXorientation"], "rd");
        EXPECT_EQ(file["keyValue"]["KTXwriter"].get<std::string>().substr(0, 7), "kokage ");
        EXPECT_EQ(text_of(file["keyValue"]["kokage.lobe"]), "ggx");
        EXPECT_EQ(text_of(file["keyValue"]["kokage.parameters"]), "image 0.134 0.5 1");
        const nlohmann::json& descriptor = file["dataFormatDescriptor"][0];
        EXPECT_EQ(descriptor["colorModel"], 1);       // KHR_DF_MODEL_RGBSDA
        EXPECT_EQ(descriptor["colorPrimaries"], 1);   // KHR_DF_PRIMARIES_BT709
        EXPECT_EQ(descriptor["transferFunction"], 1); // KHR_DF_TRANSFER_LINEAR
        EXPECT_EQ(descriptor["bytesPlane"][0], texel_bytes_there);
        const nlohmann::json& samples = descriptor["samples"];
        if (kFormats[f] == TexelFormat::shared_exponent) {
            ASSERT_EQ(samples.size(), 6u);
            for (int i = 0; i < 6; ++i) {
                EXPECT_EQ(samples[i]["channelType"], i / 2 + (i % 2 == 1 ? 0x20 : 0));
                EXPECT_EQ(samples[i]["bitOffset"], i % 2 == 1 ? 27 : 9 * (i / 2));
                EXPECT_EQ(samples[i]["bitLength"], i % 2 == 1 ? 4 : 8); // one less
            }
        } else {
            ASSERT_EQ(samples.size(), 4u);
            for (int i = 0; i < 4; ++i) {
                EXPECT_EQ(samples[i]["channelType"], (i == 3 ? 15 : i) + 0xc0); // float, signed
                EXPECT_EQ(samples[i]["bitOffset"], i * 2 * texel_bytes_there);
                EXPECT_EQ(samples[i]["sampleUpper"], 0x3f800000);
            }
        }
        ASSERT_EQ(file["levels"].size(), 4u);
        for (std::size_t i = 0; i < 4; ++i) {
            const std::string data = bytes_from_base64(file["levels"][i]["levelData"]);
            const std::vector<glm::vec3>& texels = cube.levels[i].texels;
            EXPECT_EQ(file["levels"][i]["uncompressedByteLength"], data.size());
            ASSERT_EQ(data.size(), texels.size() * std::size_t(texel_bytes_there));
            for (std::size_t t = 0; t < texels.size(); ++t) {
                const char* at = data.data() + t * std::size_t(texel_bytes_there);
                std::uint16_t halves[4];
                glm::vec4 floats;
                std::uint32_t shared;
                if (kFormats[f] == TexelFormat::half_rgb) {
                    std::memcpy(halves, at, 8);
                    EXPECT_EQ(halves[1], half_from_float(texels[t].g));
                    EXPECT_EQ(halves[3], 0x3c00); // 1
                } else if (kFormats[f] == TexelFormat::float_rgb) {
                    std::memcpy(&floats, at, 16);
                    EXPECT_EQ(floats, glm::vec4(texels[t], 1.f));
                } else {
                    std::memcpy(&shared, at, 4);
                    EXPECT_LT(glm::distance(rgb_from_shared_exponent(shared), texels[t]), 0.01f);
                }
            }
        }
    }
}

TEST(CubeFile, ParseDdsFindsTheSameImages) {
    const std::string modules = node_modules_with("parse-dds");
    if (modules.empty())
        GTEST_SKIP() << "skipped: the npm package parse-dds is missing (.ci/setup tests)";
    TemporaryFolder folder;
    const PrefilteredCube cube = smooth_cube({.size = 8, .parameters = {0, 0.2, 0.5, 1}}); // it wants all levels
    write_dds(folder / "a.dds", cube, TexelFormat::float_rgb);
    const std::string bytes = read_text(folder / "a.dds");
    const nlohmann::json all = run_node("parse_dds.js", {modules, (folder / "a.dds").string()});
    ASSERT_EQ(all.size(), 1u);
    EXPECT_EQ(all[0]["format"], "rgba32f");
    EXPECT_EQ(all[0]["cubemap"], true);
    ASSERT_EQ(all[0]["images"].size(), 24u);
    for (std::size_t i = 0; i < 24; ++i) { // face after face, each with its levels
        const nlohmann::json& image = all[0]["images"][i];
        const PrefilteredCube::Level& level = cube.levels[i % 4];
        EXPECT_EQ(image["shape"], (std::vector<int>{level.size, level.size}));
        for (int y = 0; y < level.size; ++y)
            for (int x = 0; x < level.size; ++x) {
                glm::vec4 texel;
                const std::size_t at = image["offset"].get<std::size_t>() + 16 * std::size_t(y * level.size + x);
                ASSERT_LE(at + 16, bytes.size());
                std::memcpy(&texel, bytes.data() + at, 16);
                EXPECT_EQ(texel, glm::vec4(level.texels[cube_texel_index(int(i / 4), x, y, level.size)], 1.f));
            }
    }
}

/// Changes `count` bytes at `at` to a little-endian number.
void put(std::string& bytes, std::size_t at, std::uint64_t value, std::size_t count = 4) {
    for (std::size_t i = 0; i < count; ++i)
        bytes[at + i] = char(value >> (8 * i) & 255u);
}

struct Damage {
    std::string what, words;
    std::function<void(std::string&)> make;
};

void expect_refused(const std::string& good, const std::string& name, const std::vector<Damage>& all,
                    const std::function<void(const std::filesystem::path&)>& read) {
    TemporaryFolder folder;
    for (const Damage& damage : all) {
        std::string bytes = good;
        damage.make(bytes);
        std::ofstream(folder / name, std::ios::binary | std::ios::trunc) << bytes;
        try {
            read(folder / name);
            ADD_FAILURE() << damage.what << " was read";
        } catch (const InputError& error) {
            const std::string line = error.what();
            EXPECT_NE(line.find(damage.words), std::string::npos) << damage.what << ": " << line;
            EXPECT_TRUE(line.starts_with((folder / name).string())) << line;
        }
    }
}

TEST(CubeFile, DamagedKtx2FilesAreRefusedByName) {
    TemporaryFolder folder;
    write_ktx2(folder / "a.ktx2", filtered_cube(), TexelFormat::half_rgb);
    const std::string good = read_text(folder / "a.ktx2");
    const std::size_t index = 80;
    const std::vector<Damage> all = {
        {"empty", "not a KTX 2.0 file", [](std::string& b) { b.clear(); }},
        {"a PNG", "not a KTX 2.0 file", [](std::string& b) { b.replace(0, 4, "\x89PNG"); }},
        {"KTX 1", "another version", [](std::string& b) { b.replace(5, 2, "11"); }},
        {"KTX 2.1", "another version", [](std::string& b) { b[6] = '1'; }},
        {"cut in the header", "cut off within its header", [](std::string& b) { b.resize(50); }},
        {"cut in the index", "cut off within its level index", [](std::string& b) { b.resize(100); }},
        {"cut in the descriptor", "data format descriptor", [](std::string& b) { b.resize(200); }},
        {"cut in a level", "lies outside of its", [](std::string& b) { b.resize(b.size() - 1); }},
        {"longer", "1 bytes after its last level", [](std::string& b) { b += 'x'; }},
        {"BC6H", "VkFormat 143", [](std::string& b) { put(b, 12, 143); }},
        {"other format", "contradicts", [](std::string& b) { put(b, 12, 109), put(b, 16, 4); }},
        {"type size", "type size is 4", [](std::string& b) { put(b, 16, 4); }},
        {"no width", "square", [](std::string& b) { put(b, 20, 0); }},
        {"huge", "at most 16384", [](std::string& b) { put(b, 20, 0xffffffff), put(b, 24, 0xffffffff); }},
        {"not square", "square", [](std::string& b) { put(b, 24, 8); }},
        {"a volume", "flat", [](std::string& b) { put(b, 28, 2); }},
        {"an array", "array of 3", [](std::string& b) { put(b, 32, 3); }},
        {"one face", "1 face(s)", [](std::string& b) { put(b, 36, 1); }},
        {"too many levels", "more than faces of 16", [](std::string& b) { put(b, 40, 6); }},
        {"very many levels", "more than faces", [](std::string& b) { put(b, 40, 0xffffffff); }},
        {"another size", "is said to have", [](std::string& b) { put(b, 20, 32), put(b, 24, 32); }},
        {"zstd", "supercompressed (scheme 2)", [](std::string& b) { put(b, 44, 2); }},
        {"descriptor elsewhere", "is said to begin", [](std::string& b) { put(b, 48, 0xfffffff0); }},
        {"descriptor long", "lies outside", [](std::string& b) { put(b, 52, 0xfffffff0); }},
        {"keys long", "lies outside", [](std::string& b) { put(b, 60, 0xfffffff0); }},
        {"supercompression data", "supercompression", [](std::string& b) { put(b, 72, 1, 8); }},
        {"level offset", "lies outside", [=](std::string& b) { put(b, index, ~0ull, 8); }},
        {"level offset off by 8", "is said to begin at",
         [=](std::string& b) { put(b, index + 72, std::uint64_t(static_cast<unsigned char>(b[index + 72])) + 8, 1); }},
        {"level length", "is said to have", [=](std::string& b) { put(b, index + 8, ~0ull, 8); }},
        {"uncompressed", "is said to have", [=](std::string& b) { put(b, index + 16, 5, 8); }},
        {"srgb", "transfer function 2", [=](std::string& b) { b[index + 4 * 24 + 14] = 2; }},
        {"display p3", "primaries", [=](std::string& b) { b[index + 4 * 24 + 13] = 10; }},
        {"key length", "key/value data is damaged", [=](std::string& b) { put(b, index + 4 * 24 + 92, 1u << 30); }},
        {"key twice", "twice",
         [](std::string& b) { b.replace(b.find("kokage.parameters"), 17, std::string("kokage.lobe\0xxxxx", 17)); }},
        {"lobe", "kokage.lobe", [](std::string& b) { b.replace(b.find("ggx"), 3, "gxg"); }},
        {"parameters", "do not fit its 4 levels", [](std::string& b) { b.replace(b.find("image 0.134"), 5, "0.5 1"); }},
        {"orientation", "KTXorientation is 'ru'", [](std::string& b) { b.replace(b.find("rd\0"), 2, "ru"); }},
        {"a texel", "kokage.checksum differs", [](std::string& b) { b[b.size() - 100] ^= 1; }},
        {"a roughness", "kokage.checksum differs", [](std::string& b) { b.replace(b.find("0.134"), 5, "0.234"); }},
        {"a texel, beside a checksum alone", "kokage.checksum differs",
         [](std::string& b) {
             b.replace(b.find("kokage.lobe"), 6, "others");
             b.replace(b.find("kokage.parameters"), 6, "others");
             b[b.size() - 100] ^= 1;
         }},
        {"another's infinite texel", "not finite",
         [](std::string& b) {
             b.replace(b.find("kokage.checksum"), 6, "foreign");
             b.replace(b.find("foreign"), 7, "hayama"); // any other key
             put(b, b.size() - 8, 0x7c00, 2);
         }},
    };
    expect_refused(good, "damaged.ktx2", all, [](const auto& path) { read_ktx2(path); });
}

TEST(CubeFile, DamagedDdsFilesAreRefusedByName) {
    TemporaryFolder folder;
    write_dds(folder / "a.dds", filtered_cube(), TexelFormat::half_rgb);
    const std::vector<Damage> all = {
        {"empty", "not a DDS file", [](std::string& b) { b.clear(); }},
        {"cut in the header", "cut off within its header", [](std::string& b) { b.resize(50); }},
        {"cut in the DX10 header", "DX10", [](std::string& b) { b.resize(140); }},
        {"cut", "it is cut off", [](std::string& b) { b.resize(b.size() - 1); }},
        {"longer", "it is damaged", [](std::string& b) { b += "x"; }},
        {"header size", "other sizes", [](std::string& b) { put(b, 4, 125); }},
        {"DXT5", "neither half floats nor floats", [](std::string& b) { b.replace(84, 4, "DXT5"); }},
        {"BC6H", "DXGI format 95", [](std::string& b) { put(b, 128, 95); }},
        {"8 bits", "not floating-point", [](std::string& b) { put(b, 80, 0x41); }},
        {"flat", "not a cube map", [](std::string& b) { put(b, 136, 0); }},
        {"an array", "array of 2", [](std::string& b) { put(b, 140, 2); }},
        {"some faces", "all six faces", [](std::string& b) { put(b, 112, 0x7e00); }},
        {"huge", "at most 16384", [](std::string& b) { put(b, 12, 1u << 30), put(b, 16, 1u << 30); }},
        {"another size", "take", [](std::string& b) { put(b, 12, 32), put(b, 16, 32); }},
        {"levels", "more than faces", [](std::string& b) { put(b, 28, 9); }},
        {"a texel", "checksum", [](std::string& b) { b[b.size() - 100] ^= 1; }},
        {"a roughness", "checksum", [](std::string& b) { b[49] ^= 1; }},
        {"the lobe", "checksum", [](std::string& b) { b[36] = 0; }},
        {"another's infinite texel", "not finite",
         [](std::string& b) { b[32] = 'X', put(b, b.size() - 8, 0x7c00, 2); }},
    };
    expect_refused(read_text(folder / "a.dds"), "damaged.dds", all, [](const auto& path) { read_dds(path); });
}

TEST(CubeFile, AnotherProgramsFilesAreReadWithEvenRoughness) {
    TemporaryFolder folder;
    const PrefilteredCube cube = filtered_cube();
    write_ktx2(folder / "a.ktx2", cube, TexelFormat::half_rgb);
    write_dds(folder / "a.dds", cube, TexelFormat::half_rgb);
    std::string ktx2 = read_text(folder / "a.ktx2"), dds = read_text(folder / "a.dds");
    for (const char* key : {"kokage.lobe", "kokage.parameters", "kokage.checksum"})
        ktx2.replace(ktx2.find(key), 6, "others");
    dds.replace(32, 4, "GIMP");
    std::ofstream(folder / "b.ktx2", std::ios::binary) << ktx2;
    std::ofstream(folder / "b.dds", std::ios::binary) << dds;
    for (const CubeFile& file : {read_ktx2(folder / "b.ktx2"), read_dds(folder / "b.dds")}) {
        EXPECT_FALSE(file.lobes_known);
        EXPECT_EQ(file.cube.kind, LobeKind::ggx);
        ASSERT_EQ(file.cube.levels.size(), 4u);
        EXPECT_TRUE(file.cube.levels[0].unfiltered);
        EXPECT_DOUBLE_EQ(file.cube.levels[1].parameter, 1 / 3.);
        EXPECT_NEAR(file.cube.levels[2].texels[9].g, cube.levels[2].texels[9].g, 0.001f);
    }
    // Direct3D 9's way to say the same: no DX10 header, the format as a number in the place of four characters.
    std::string old = read_text(folder / "a.dds");
    old.erase(128, 20);
    put(old, 84, 113);
    old.replace(32, 4, "GIMP");
    std::ofstream(folder / "c.dds", std::ios::binary) << old;
    EXPECT_NEAR(read_dds(folder / "c.dds").cube.levels[2].texels[9].g, cube.levels[2].texels[9].g, 0.001f);
}

} // namespace
} // namespace kokage
