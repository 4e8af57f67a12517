// Damaged EXR maps: bytes changed, numbers replaced, cut off and spliced, and headers that contradict themselves under
// a checksum that is right. Each is refused with one line, or read as a map that holds together, and none takes memory
// that its bytes can't fill.
#include "common/services/error.h"
#include "reflection/maps/exr_notes.h"
#include "reflection/maps/map_file.h"
#include "tests/support/mutants.h"
#include "tests/support/temporary_folder.h"

#include <cmath>
#include <gtest/gtest.h>
#include <sys/resource.h>

namespace kokage {
namespace {

std::vector<glm::vec3> some_texels(std::size_t count) {
    Random random(4);
    std::vector<glm::vec3> texels(count);
    for (glm::vec3& texel : texels)
        texel = {random.uniform(), random.uniform(0, 100), 0.25f};
    return texels;
}

ShellMap small_shells() {
    ShellMap map({.least_parameter = 2, .most_parameter = 9.5});
    map.set_texels(some_texels(map.layout().size()));
    return map;
}

VoxelCube small_cube() {
    VoxelCube cube(LobeKind::phong, RoughnessScale::solved(8));
    cube.set_texels(some_texels(cube.layout().size()));
    return cube;
}

double peak_megabytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return double(usage.ru_maxrss) / 1024;
}

struct Outcome {
    int read = 0, refused = 0;
};

void expect_whole(const ShellMap& map) {
    for (const glm::vec3 direction : {glm::vec3(1, 0, 0), glm::vec3(0, 0, -1)}) {
        const glm::vec3 value = map.lookup(direction, 5.0);
        EXPECT_TRUE(std::isfinite(value.x) && std::isfinite(value.y) && std::isfinite(value.z));
    }
    EXPECT_EQ(map.texels().size(), map.bytes());
}

void expect_whole(const VoxelCube& cube) {
    EXPECT_EQ(cube.voxels().size(), std::size_t(cube.size()) * std::size_t(cube.size()) * std::size_t(cube.size()));
    for (const glm::vec3& voxel : cube.voxels())
        EXPECT_TRUE(std::isfinite(voxel.x) && std::isfinite(voxel.y) && std::isfinite(voxel.z));
}

void read_mutant(const std::filesystem::path& path, const std::string& which, Outcome& outcome) {
    try {
        const MapFile file = read_map(path);
        ++outcome.read;
        std::visit([](const auto& map) { expect_whole(map); }, file.map);
    } catch (const InputError& error) {
        ++outcome.refused;
        const std::string line = error.what();
        EXPECT_TRUE(line.starts_with("cannot read map '" + path.string() + "': ")) << which << ": " << line;
        EXPECT_LT(line.size(), path.string().size() + 400) << which << ": " << line;
    } catch (const std::exception& error) {
        ADD_FAILURE() << which << ": not an InputError: " << error.what();
    }
}

Outcome read_mutants(const std::string& good, const std::filesystem::path& path, int count) {
    const std::size_t head = std::min(good.rfind("kokage:") + 300, good.size()); // the header and the table of lines
    const double before = peak_megabytes();
    Outcome outcome;
    for (int i = 0; i < count; ++i) {
        Random random(std::uint64_t(i), good.size());
        std::ofstream(path, std::ios::binary | std::ios::trunc) << mutant_of(good, head, random);
        read_mutant(path, "mutant " + std::to_string(i), outcome);
    }
    EXPECT_LT(peak_megabytes() - before, 200);
    return outcome;
}

constexpr int kMutants = 2000; ///< of each kind of map

TEST(MutatedMapFiles, Shells) {
    const TemporaryFolder folder(parent_in_memory());
    write_map(folder / "good.exr", small_shells(), "a sky");
    const Outcome outcome = read_mutants(read_text(folder / "good.exr"), folder / "mutant.exr", kMutants);
    EXPECT_GT(outcome.refused, kMutants / 2); // what is left: attributes that say nothing of the map
    EXPECT_GT(outcome.read, 0);
}

TEST(MutatedMapFiles, VoxelCubes) {
    const TemporaryFolder folder(parent_in_memory());
    write_map(folder / "good.exr", small_cube(), TexelFormat::float_rgb, "a sky");
    const Outcome outcome = read_mutants(read_text(folder / "good.exr"), folder / "mutant.exr", kMutants);
    EXPECT_GT(outcome.refused, kMutants / 2);
    EXPECT_GT(outcome.read, 0);
}

/// What a stranger could write who computes checksums.
TEST(MutatedMapFiles, HeadersThatContradictTheirPixelsUnderARightChecksum) {
    const TemporaryFolder folder(parent_in_memory());
    const char* values[] = {"0", "-1",   "1e-300", "1e300", "nan",   "inf",        "1.0000001", "65536", "4294967296",
                            "",  "half", "float",  "ggx",   "cubic", "voxel cube", "shells",    "1022",  "0.5"};
    const double before = peak_megabytes();
    Outcome outcome;
    for (const bool cube : {false, true}) {
        if (cube)
            write_map(folder / "good.exr", small_cube(), TexelFormat::half_rgb);
        else
            write_map(folder / "good.exr", small_shells());
        const ExrHeader header = read_exr_header(folder / "good.exr");
        const Image image = read_noted_exr(folder / "good.exr", header);
        for (const auto& [key, good] : header.notes)
            for (const char* value : values) {
                ExrNotes notes = header.notes;
                notes[key] = value;
                write_noted_exr(folder / "mutant.exr", exr_pixels(image, true), notes);
                read_mutant(folder / "mutant.exr", key + " " + value, outcome);
            }
    }
    EXPECT_LT(peak_megabytes() - before, 200);
    EXPECT_GT(outcome.refused, 100);
    EXPECT_GT(outcome.read, 10);
}

} // namespace
} // namespace kokage
