#include "common/services/error.h"
#include "common/services/output_file.h"
#include "tests/support/temporary_folder.h"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <sstream>

namespace fs = std::filesystem;
using namespace kokage;

namespace {

class OutputFileTest : public ::testing::Test {
  protected:
    std::size_t files() const {
        return std::size_t(std::distance(fs::directory_iterator(folder), fs::directory_iterator{}));
    }
    TemporaryFolder temporary;
    const fs::path folder = temporary.path();
};

TEST_F(OutputFileTest, AppearsWholeOnCommitAndNotBefore) {
    OutputFile file(folder / "a.txt");
    file.write("half");
    EXPECT_FALSE(fs::exists(folder / "a.txt"));
    EXPECT_EQ(file.temporary_path().extension(), ".txt");
    EXPECT_EQ(file.temporary_path().parent_path(), folder);
    file.write(" whole");
    file.commit();
    EXPECT_EQ(read_text(folder / "a.txt"), "half whole");
    EXPECT_EQ(files(), 1u);
}

TEST_F(OutputFileTest, LeavesWhatWasThereWhenStopped) {
    write_file(folder / "a.txt", "before");
    try {
        OutputFile file(folder / "a.txt");
        file.write("after");
        throw Stopped();
    } catch (const Stopped&) {
    }
    EXPECT_EQ(read_text(folder / "a.txt"), "before");
    EXPECT_EQ(files(), 1u);
}

TEST_F(OutputFileTest, ReplacesAndKeepsPermissions) {
    write_file(folder / "a.txt", "before");
    fs::permissions(folder / "a.txt", fs::perms::owner_read | fs::perms::owner_write);
    write_file(folder / "a.txt", "after");
    EXPECT_EQ(read_text(folder / "a.txt"), "after");
    EXPECT_EQ(fs::status(folder / "a.txt").permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(OutputFileTest, FollowsLinks) {
    write_file(folder / "real.txt", "before");
    fs::create_symlink("real.txt", folder / "link.txt");
    write_file(folder / "link.txt", "after");
    EXPECT_TRUE(fs::is_symlink(folder / "link.txt"));
    EXPECT_EQ(read_text(folder / "real.txt"), "after");
    EXPECT_EQ(files(), 2u);
}

TEST_F(OutputFileTest, WritesToDevicesWithoutReplacingThem) {
    write_file("/dev/null", "nothing");
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(OutputFileTest, TwoWritersOfOnePathDoNotDisturbEachOther) {
    OutputFile first(folder / "a.txt"), second(folder / "a.txt");
    first.write("first");
    second.write("second");
    first.commit();
    second.commit();
    EXPECT_EQ(read_text(folder / "a.txt"), "second");
}

TEST_F(OutputFileTest, RefusesFoldersAndMissingFolders) {
    for (const fs::path& path : {folder, folder / "", folder / "missing" / "a.txt", fs::path()})
        try {
            OutputFile file(path);
            ADD_FAILURE() << "accepted '" << path << "'";
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find("cannot write '" + path.string()), std::string::npos)
                << error.what();
        }
    EXPECT_EQ(files(), 0u);
}

TEST_F(OutputFileTest, SaysWhenTheDiskIsFull) {
    if (!fs::exists("/dev/full"))
        GTEST_SKIP() << "skipped: no /dev/full here";
    EXPECT_THROW(write_file("/dev/full", std::string(100000, 'x')), InputError);
}

TEST_F(OutputFileTest, RelativeNamesGoToTheCurrentFolder) {
    const fs::path before = fs::current_path();
    fs::current_path(folder);
    write_file("a.txt", "here");
    fs::current_path(before);
    EXPECT_EQ(read_text(folder / "a.txt"), "here");
}

} // namespace
