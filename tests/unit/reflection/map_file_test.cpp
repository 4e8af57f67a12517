// Maps as EXR files: the same texels come back, and whatever is wrong with a file is said.
#include "reflection/maps/map_file.h"

#include "common/scene/image_file.h"
#include "common/services/error.h"
#include "common/services/random.h"
#include "reflection/maps/exr_notes.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/common/scene_builders.h"

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>

namespace kokage {
namespace {

std::vector<glm::vec3> random_texels(std::size_t count, float least, float most) {
    Random random(9);
    std::vector<glm::vec3> texels(count);
    for (glm::vec3& texel : texels)
        for (int c = 0; c < 3; ++c)
            texel[c] = std::exp(random.uniform(least, most));
    return texels;
}

ShellMap random_shells(TexelFormat format, TexelFilter filter, LobeKind kind = LobeKind::phong) {
    const bool phong = kind == LobeKind::phong;
    ShellMap map({.kind = kind,
                  .least_parameter = phong ? 1.37 : 0.3,
                  .most_parameter = phong ? 123.4 : 0.9,
                  .filter = filter,
                  .format = format});
    map.set_texels(random_texels(map.layout().size(), -9, 9));
    return map;
}

std::string error_of(const std::filesystem::path& path) {
    try {
        read_map(path);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

void write_bytes(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

TEST(MapFile, ShellsComeBackBitByBit) {
    const TemporaryFolder folder;
    for (const TexelFormat format : {TexelFormat::half_rgb, TexelFormat::float_rgb, TexelFormat::shared_exponent})
        for (const TexelFilter filter : {TexelFilter::bilinear, TexelFilter::cubic})
            for (const LobeKind kind : {LobeKind::phong, LobeKind::ggx}) {
                const ShellMap map = random_shells(format, filter, kind);
                write_map(folder / "map.exr", map, "a sky");
                EXPECT_TRUE(is_map_file(folder / "map.exr"));
                const MapFile file = read_map(folder / "map.exr");
                EXPECT_EQ(file.made_from, "a sky");
                const ShellMap& back = std::get<ShellMap>(file.map);
                ASSERT_EQ(back.shells().size(), map.shells().size());
                ASSERT_TRUE(
                    std::equal(map.texels().begin(), map.texels().end(), back.texels().begin(), back.texels().end()));
                const glm::vec3 direction = glm::normalize(glm::vec3(1, 2, -3));
                for (const double parameter : {0.5, 30.0})
                    EXPECT_EQ(back.lookup(direction, parameter), map.lookup(direction, parameter));
            }
}

TEST(MapFile, VoxelsComeBackBitByBitAsFloatsAndRoundedAsHalves) {
    const TemporaryFolder folder;
    VoxelCube cube(LobeKind::phong, RoughnessScale::as_printed(10, 256));
    cube.set_texels(random_texels(cube.layout().size(), -5, 5));
    write_map(folder / "cube.exr", cube, TexelFormat::float_rgb);
    const MapFile file = read_map(folder / "cube.exr");
    const VoxelCube& back = std::get<VoxelCube>(file.map);
    EXPECT_EQ(back.scale().u(), 6.2);
    EXPECT_EQ(file.made_from, "");
    ASSERT_TRUE(std::equal(cube.voxels().begin(), cube.voxels().end(), back.voxels().begin(), back.voxels().end()));
    write_map(folder / "half.exr", cube);
    const VoxelCube halves = std::get<VoxelCube>(read_map(folder / "half.exr").map);
    for (std::size_t i = 0; i < cube.voxels().size(); ++i)
        for (int c = 0; c < 3; ++c)
            ASSERT_NEAR(halves.voxels()[i][c], cube.voxels()[i][c], cube.voxels()[i][c] / 2048);
    EXPECT_THROW(write_map(folder / "cube.exr", cube, TexelFormat::shared_exponent), InputError);
}

TEST(MapFile, EveryCompressionHoldsTheSameTexels) {
    const TemporaryFolder folder;
    VoxelCube cube(LobeKind::phong, RoughnessScale::solved(16));
    cube.set_texels(random_texels(cube.layout().size(), 0, 1));
    const ShellMap shells = random_shells(TexelFormat::float_rgb, TexelFilter::bilinear);
    std::vector<std::uintmax_t> sizes;
    for (const ExrCompression compression : {ExrCompression::zip, ExrCompression::rle, ExrCompression::none}) {
        write_map(folder / "cube.exr", cube, TexelFormat::float_rgb, "", compression);
        const VoxelCube read = std::get<VoxelCube>(read_map(folder / "cube.exr").map);
        EXPECT_TRUE(std::equal(read.voxels().begin(), read.voxels().end(), cube.voxels().begin()));
        sizes.push_back(std::filesystem::file_size(folder / "cube.exr"));
        write_map(folder / "shells.exr", shells, "", compression);
        const ShellMap again = std::get<ShellMap>(read_map(folder / "shells.exr").map);
        EXPECT_TRUE(std::equal(again.texels().begin(), again.texels().end(), shells.texels().begin()));
    }
    EXPECT_LT(sizes[0], sizes[2]);
    EXPECT_LT(sizes[1], sizes[2]) << "corners are black";
}

TEST(MapFile, APackedMapIsWrittenAsItWas) {
    const TemporaryFolder folder;
    VoxelCube cube(LobeKind::phong, RoughnessScale::solved(4));
    const auto texels = random_texels(cube.layout().size(), 0, 1);
    cube.set_texels(texels);
    const auto write = packed_map(folder / "cube.exr", cube, TexelFormat::float_rgb, "", ExrCompression::none);
    EXPECT_FALSE(std::filesystem::exists(folder / "cube.exr"));
    cube.set_texels(std::vector<glm::vec3>(texels.size(), glm::vec3(5)));
    write();
    const VoxelCube read = std::get<VoxelCube>(read_map(folder / "cube.exr").map);
    cube.set_texels(texels);
    EXPECT_TRUE(std::equal(read.voxels().begin(), read.voxels().end(), cube.voxels().begin()));
}

TEST(MapFile, AVoxelCubesRangeComesBackAndIsChecked) {
    const TemporaryFolder folder;
    VoxelCube cube(LobeKind::ggx, RoughnessScale::solved(16), {0.3, 1.0 / 3});
    cube.set_texels(random_texels(cube.layout().size(), -5, 5));
    write_map(folder / "cube.exr", cube, TexelFormat::float_rgb);
    const MapFile file = read_map(folder / "cube.exr");
    const VoxelCube& back = std::get<VoxelCube>(file.map);
    EXPECT_EQ(back.range().roughest, 0.3);
    EXPECT_EQ(back.range().smoothest, 1.0 / 3);
    EXPECT_LT(back.size(), 12);
    for (const float smoothness : {0.f, 0.31f, 1.f}) {
        const glm::vec3 value = cube.lookup({0.6f, 0, -0.8f}, smoothness);
        EXPECT_EQ(back.lookup({0.6f, 0, -0.8f}, smoothness), value);
        EXPECT_GT(value.r, 0.f);
    }
    const ExrHeader header = read_exr_header(folder / "cube.exr");
    const Image image = read_noted_exr(folder / "cube.exr", header);
    for (const auto& [range, why] : {std::pair{"0 1", "describes a map of 18 x 324"},
                                     {"0.6 0.3", "describes no map"},
                                     {"0.3", "not two numbers"},
                                     {"0.3 x", "not two numbers"}}) {
        ExrNotes notes = header.notes;
        notes["smoothness"] = range;
        notes.erase("checksum");
        write_noted_exr(folder / "changed.exr", exr_pixels(image, false), notes);
        EXPECT_NE(error_of(folder / "changed.exr").find(why), std::string::npos) << error_of(folder / "changed.exr");
    }
}

TEST(MapFile, AnotherProgramSeesAPictureOfTheShells) {
    const TemporaryFolder folder;
    write_map(folder / "map.exr", random_shells(TexelFormat::half_rgb, TexelFilter::bilinear));
    const Image image = load_image(folder / "map.exr");
    EXPECT_EQ(image.channels, 3);
    EXPECT_GT(image.width, 90);
}

TEST(MapFile, WhatIsNoMapIsRefused) {
    const TemporaryFolder folder;
    EXPECT_NE(error_of(folder / "none.exr").find("there is no such file"), std::string::npos);
    EXPECT_NE(error_of(folder.path()).find("it is no file"), std::string::npos);
    write_bytes(folder / "text.exr", "no picture at all");
    EXPECT_NE(error_of(folder / "text.exr").find("no EXR file, or damaged"), std::string::npos);
    save_image(folder / "picture.exr", Image(4, 4, 3));
    EXPECT_NE(error_of(folder / "picture.exr").find("without the attributes of a map"), std::string::npos);
    EXPECT_FALSE(is_map_file(folder / "picture.exr"));
    EXPECT_FALSE(is_map_file(folder / "text.exr"));
}

TEST(MapFile, OtherVersionsAndSizesAreRefusedByName) {
    const TemporaryFolder folder;
    write_map(folder / "map.exr", random_shells(TexelFormat::half_rgb, TexelFilter::bilinear));
    const ExrHeader header = read_exr_header(folder / "map.exr");
    const Image image = read_noted_exr(folder / "map.exr", header);
    const auto changed = [&](const std::string& key, const std::string& value) {
        ExrNotes notes = header.notes;
        notes[key] = value;
        notes.erase("checksum");
        if (value.empty())
            notes.erase(key);
        write_noted_exr(folder / "changed.exr", exr_pixels(image, true), notes);
        return error_of(folder / "changed.exr");
    };
    EXPECT_NE(changed("layout_version", "1").find("version '1', this program reads version 2"), std::string::npos);
    EXPECT_NE(changed("most_parameter", "5000").find("but its header describes a map of"), std::string::npos);
    EXPECT_NE(changed("most_parameter", "nan").find("not a number"), std::string::npos);
    EXPECT_NE(changed("most_parameter", "-4").find("describes no map"), std::string::npos);
    EXPECT_NE(changed("shell_ratio", "1.0000000001").find("describes no map"), std::string::npos);
    EXPECT_NE(changed("lobe", "beckmann").find("'beckmann', which this program does not know"), std::string::npos);
    EXPECT_NE(changed("filter", "").find("lacks kokage:filter"), std::string::npos);
    EXPECT_NE(changed("map", "donut").find("neither shells nor a voxel cube"), std::string::npos);
    for (const auto& [key, value] : header.notes)
        if (key != "shells" && key != "checksum") { // the first is for other programs
            EXPECT_NE(changed(key, ""), "") << key;
        }
}

TEST(MapFile, AlteredAndTruncatedFilesAreRefused) {
    const TemporaryFolder folder;
    write_map(folder / "map.exr", random_shells(TexelFormat::half_rgb, TexelFilter::bilinear));
    const std::string whole = read_text(folder / "map.exr");
    for (std::size_t i = 0; i < 40; ++i) {
        write_bytes(folder / "cut.exr", whole.substr(0, whole.size() * i / 40));
        EXPECT_NE(error_of(folder / "cut.exr"), "") << i;
    }
    write_bytes(folder / "cut.exr", whole.substr(0, whole.size() - 1));
    EXPECT_NE(error_of(folder / "cut.exr"), "");
    const std::size_t pixels = whole.rfind("kokage:") + 2000; // behind the header and the table of lines
    for (std::size_t at = pixels; at < whole.size(); at += whole.size() / 60) {
        std::string altered = whole;
        altered[at] = char(altered[at] ^ 4);
        write_bytes(folder / "altered.exr", altered);
        EXPECT_NE(error_of(folder / "altered.exr"), "") << at;
    }
    // A note that still makes sense, but is not the one that was written.
    std::string renamed = whole;
    const std::size_t lobe = renamed.find("123.4");
    ASSERT_NE(lobe, std::string::npos);
    renamed.replace(lobe, 5, "123.5");
    write_bytes(folder / "altered.exr", renamed);
    EXPECT_NE(error_of(folder / "altered.exr").find("the checksum differs"), std::string::npos);
}

TEST(MapFile, ValuesThatAreNotFiniteAreNotWritten) {
    const TemporaryFolder folder;
    VoxelCube cube(LobeKind::phong, RoughnessScale::solved(4));
    auto texels = random_texels(cube.layout().size(), 0, 1);
    texels[3].g = std::numeric_limits<float>::quiet_NaN();
    cube.set_texels(texels);
    EXPECT_THROW(write_map(folder / "cube.exr", cube, TexelFormat::float_rgb), InputError);
    EXPECT_FALSE(std::filesystem::exists(folder / "cube.exr"));
}

} // namespace
} // namespace kokage
