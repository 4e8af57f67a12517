// Damaged cube maps: bytes changed, numbers replaced, cut off and spliced, by the thousand. Each is refused with one
// line, or gives a cube that holds together.
#include "common/services/error.h"
#include "reflection/maps/cube_file.h"
#include "tests/support/cube_maps.h"
#include "tests/support/mutants.h"
#include "tests/support/temporary_folder.h"

#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

using ReadBytes = CubeFile (*)(std::span<const unsigned char>, const std::string&);

struct Outcome {
    int read = 0, refused = 0;
};

Outcome read_mutants(const std::string& good, std::size_t head, const std::string& name, int count, ReadBytes read) {
    Outcome outcome;
    for (int i = 0; i < count; ++i) {
        Random random(std::uint64_t(i), good.size());
        const std::string bytes = mutant_of(good, head, random);
        try {
            const CubeFile file = read({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()}, name);
            ++outcome.read;
            for (const PrefilteredCube::Level& level : file.cube.levels) {
                EXPECT_EQ(level.texels.size(), 6 * std::size_t(level.size) * std::size_t(level.size));
                for (const glm::vec3& texel : level.texels)
                    EXPECT_TRUE(std::isfinite(texel.r) && std::isfinite(texel.g) && std::isfinite(texel.b));
                EXPECT_TRUE(level.unfiltered || (level.parameter >= 0 && std::isfinite(level.parameter)));
            }
        } catch (const InputError& error) {
            ++outcome.refused;
            const std::string line = error.what();
            EXPECT_TRUE(line.starts_with(name + ": ")) << line;
            EXPECT_LT(line.size(), name.size() + 250) << line;
        } catch (const std::exception& error) {
            ADD_FAILURE() << "mutant " << i << " of " << name << ": not an InputError: " << error.what();
        }
    }
    return outcome;
}

constexpr int kMutants = 10000; ///< of each kind of file

TEST(MutatedCubeFiles, Ktx2) {
    TemporaryFolder folder;
    for (const TexelFormat format : {TexelFormat::half_rgb, TexelFormat::float_rgb, TexelFormat::shared_exponent}) {
        write_ktx2(folder / "a.ktx2", smooth_cube({.size = 8, .parameters = {0, 0.4, 1}}), format);
        const std::string good = read_text(folder / "a.ktx2");
        const Outcome outcome = read_mutants(good, 500, "mutant.ktx2", kMutants, read_ktx2);
        EXPECT_GT(outcome.refused, kMutants * 9 / 10); // what is left: ranges of samples, padding, who wrote it
    }
}

TEST(MutatedCubeFiles, Dds) {
    TemporaryFolder folder;
    for (const TexelFormat format : {TexelFormat::half_rgb, TexelFormat::float_rgb}) {
        write_dds(folder / "a.dds", smooth_cube({.size = 8, .parameters = {0, 0.4, 1}}), format);
        const Outcome outcome = read_mutants(read_text(folder / "a.dds"), 148, "mutant.dds", kMutants, read_dds);
        EXPECT_GT(outcome.refused, kMutants / 2); // many of the header's fields say nothing to a reader
    }
}

TEST(MutatedCubeFiles, WithoutAChecksumTheRestStillHolds) {
    TemporaryFolder folder;
    const PrefilteredCube cube = smooth_cube({.size = 8, .parameters = {0, 0.4, 1}});
    write_ktx2(folder / "a.ktx2", cube, TexelFormat::half_rgb);
    write_dds(folder / "a.dds", cube, TexelFormat::half_rgb);
    std::string ktx2 = read_text(folder / "a.ktx2"), dds = read_text(folder / "a.dds");
    ktx2.replace(ktx2.find("kokage.checksum"), 6, "others");
    dds.replace(32, 4, "GIMP");
    EXPECT_GT(read_mutants(ktx2, 500, "mutant.ktx2", kMutants, read_ktx2).refused, kMutants / 2);
    EXPECT_GT(read_mutants(dds, 148, "mutant.dds", kMutants, read_dds).refused, kMutants / 4);
}

} // namespace
} // namespace kokage
