#include "common/services/error.h"
#include "tests/support/program_run.h"
#include "viewer/scene/output_check.h"

#include <sys/stat.h>

namespace kokage {
namespace {

std::string complaint(const std::filesystem::path& path) {
    try {
        check_output(path, "the shaded tree", {".glb", ".gltf"});
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(OutputCheck, GoodNamesPassAndLeaveNothingBehind) {
    TemporaryFolder folder;
    for (const char* name : {"oak.glb", "an old oak.GLB", "oak.2.gltf"})
        EXPECT_EQ(complaint(folder / name), "") << name;
    EXPECT_TRUE(folder.files().empty());
}

TEST(OutputCheck, AnExistingFileStaysAsItWas) {
    TemporaryFolder folder;
    std::ofstream(folder / "oak.glb") << "old";
    EXPECT_EQ(complaint(folder / "oak.glb"), "");
    EXPECT_EQ(read_text(folder / "oak.glb"), "old");
    EXPECT_EQ(folder.files(), std::vector<std::string>({"oak.glb"}));
}

TEST(OutputCheck, BadNamesAreRefusedWithTheReason) {
    TemporaryFolder folder;
    std::filesystem::create_directory(folder / "folder.glb");
    EXPECT_NE(complaint(folder / "oak").find("no ending"), std::string::npos);
    EXPECT_NE(complaint(folder / "oak.obj").find(".glb, .gltf"), std::string::npos);
    EXPECT_NE(complaint(folder / "folder.glb").find("folder"), std::string::npos);
    EXPECT_NE(complaint(folder / "missing" / "oak.glb").find("make it first"), std::string::npos);
    EXPECT_NE(complaint("").find("no ending"), std::string::npos);
    EXPECT_EQ(folder.files(), std::vector<std::string>({"folder.glb"}));
}

TEST(OutputCheck, TheSameFileTwiceIsRefused) {
    TemporaryFolder folder;
    EXPECT_NO_THROW(check_distinct({folder / "a.glb", folder / "b.glb", "", ""}));
    EXPECT_THROW(check_distinct({folder / "a.glb", folder / "b.png", folder / "." / "a.glb"}), InputError);
}

} // namespace
} // namespace kokage
