// How much memory is left, read from files as Linux writes them.
#include "common/services/memory.h"

#include "tests/support/temporary_folder.h"

#include <fstream>
#include <gtest/gtest.h>
#include <limits>

namespace kokage {
namespace {

constexpr std::uint64_t kUnknown = std::numeric_limits<std::uint64_t>::max();

void write(const std::filesystem::path& file, const std::string& text) {
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
}

TEST(Memory, IsTheLeastOfWhatSystemAndControlGroupsLeave) {
    const TemporaryFolder root;
    EXPECT_EQ(available_memory_bytes(root.path()), kUnknown);
    write(root / "proc/meminfo",
          "MemTotal:       9000 kB\nMemFree:  10 kB\nMemAvailable:   4000 kB\nSwapFree: 96 kB\n");
    EXPECT_EQ(available_memory_bytes(root.path()), 4096u * 1024);
    // Version 2: a limit on a group further up counts; cached files are given up.
    write(root / "proc/self/cgroup", "0::/outer/inner\n");
    write(root / "sys/fs/cgroup/outer/inner/memory.max", "max\n");
    write(root / "sys/fs/cgroup/outer/inner/memory.current", "500\n");
    EXPECT_EQ(available_memory_bytes(root.path()), 4096u * 1024);
    write(root / "sys/fs/cgroup/outer/memory.max", "300000\n");
    write(root / "sys/fs/cgroup/outer/memory.current", "100000\n");
    EXPECT_EQ(available_memory_bytes(root.path()), 200000u);
    write(root / "sys/fs/cgroup/outer/memory.stat", "anon 50000\ninactive_file 40000\n");
    EXPECT_EQ(available_memory_bytes(root.path()), 240000u);
    write(root / "sys/fs/cgroup/outer/memory.current", "400000\n");
    EXPECT_EQ(available_memory_bytes(root.path()), 0u);
    // Version 1, whose path in the container is not that outside of it: the root of the mount is its own group.
    write(root / "proc/self/cgroup", "12:cpu,cpuacct:/x\n4:memory:/docker/abc\n");
    write(root / "sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
    write(root / "sys/fs/cgroup/memory/memory.usage_in_bytes", "70000\n");
    EXPECT_EQ(available_memory_bytes(root.path()), 4096u * 1024);
    write(root / "sys/fs/cgroup/memory/memory.limit_in_bytes", "100000\n");
    EXPECT_EQ(available_memory_bytes(root.path()), 30000u);
}

TEST(Memory, OfThisMachineIsKnown) {
    if (!std::filesystem::exists("/proc/meminfo"))
        GTEST_SKIP() << "skipped: this system has no /proc/meminfo";
    EXPECT_GT(available_memory_bytes(), 1000000u);
    EXPECT_LT(available_memory_bytes(), kUnknown);
}

} // namespace
} // namespace kokage
