// Headers of EXR files that announce more than their files hold are refused before OpenEXR takes memory for them.
#include "common/scene/exr_header.h"

#include "common/scene/image_file.h"
#include "common/services/error.h"
#include "tests/support/temporary_folder.h"

#include <OpenImageIO/imageio.h>
#include <cstring>
#include <gtest/gtest.h>

namespace kokage {
namespace {

std::string problem_of(const std::string& bytes) {
    return exr_header_problem(std::as_bytes(std::span(bytes)));
}

/// Where an attribute's value begins.
std::size_t value_at(const std::string& bytes, const std::string& name, const std::string& type) {
    const std::string start = name + '\0' + type + '\0';
    const std::size_t found = bytes.find(start);
    EXPECT_NE(found, std::string::npos) << name;
    return found + start.size() + 4;
}

std::string with(std::string bytes, std::size_t at, std::uint32_t number) {
    std::memcpy(bytes.data() + at, &number, 4);
    return bytes;
}

std::string written(const std::filesystem::path& path, const char* compression, int tile) {
    OIIO::ImageSpec spec(40, 30, 3, OIIO::TypeDesc::HALF);
    spec.attribute("compression", compression);
    spec.tile_width = spec.tile_height = tile;
    const auto output = OIIO::ImageOutput::create("exr");
    const std::vector<float> pixels(40 * 30 * 3, 0.5f);
    EXPECT_TRUE(output->open(path.string(), spec) && output->write_image(OIIO::TypeDesc::FLOAT, pixels.data()) &&
                output->close());
    return read_text(path);
}

TEST(ExrHeader, OfWholeFilesHasNoProblem) {
    const TemporaryFolder folder;
    for (const char* compression : {"none", "rle", "zips", "zip", "piz", "pxr24", "b44", "dwaa", "dwab"})
        for (const int tile : {0, 16}) {
            EXPECT_EQ(problem_of(written(folder / "a.exr", compression, tile)), "") << compression << " " << tile;
            EXPECT_EQ(exr_header_problem(folder / "a.exr"), "");
        }
    EXPECT_EQ(problem_of("no EXR at all"), "");
    EXPECT_EQ(exr_header_problem(folder / "none.exr"), "");
}

TEST(ExrHeader, ThatAnnouncesWhatItsFileCantHoldIsRefusedByName) {
    const TemporaryFolder folder;
    const std::string lines = written(folder / "a.exr", "zip", 0), tiles = written(folder / "b.exr", "zip", 16);
    const std::size_t window = value_at(lines, "dataWindow", "box2i");
    const char *too_many = "pixels, more than its", *damaged = "cut off or damaged";
    const std::pair<std::string, const char*> cases[] = {
        {with(lines, window + 12, 0x7ffffffe), too_many},
        {with(with(lines, window + 4, 0x80000000), window + 12, 0x7fffffff), too_many},
        {with(lines, window + 12, 0xffffffff), "no pixels"},
        {with(lines, window - 4, 0x7fffffff), damaged}, // the attribute's size
        {with(lines, window - 4, 0xffffffff), damaged},
        {lines.substr(0, window + 3), damaged},
        {lines.substr(0, 20), damaged},
        {with(tiles, value_at(tiles, "tiles", "tiledesc"), 0), damaged},
        {with(with(tiles, value_at(tiles, "tiles", "tiledesc"), 1), value_at(tiles, "dataWindow", "box2i") + 12,
              1 << 20),
         too_many}};
    for (const auto& [bytes, words] : cases) {
        EXPECT_NE(problem_of(bytes).find(words), std::string::npos) << problem_of(bytes);
        std::ofstream(folder / "c.exr", std::ios::binary) << bytes;
        EXPECT_EQ(exr_header_problem(folder / "c.exr"), problem_of(bytes));
        for (const bool from_memory : {false, true})
            try {
                if (from_memory)
                    load_image(std::as_bytes(std::span(bytes)), "c.exr");
                else
                    load_image(folder / "c.exr");
                ADD_FAILURE() << "read: " << words;
            } catch (const InputError& error) {
                EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
            }
    }
}

} // namespace
} // namespace kokage
