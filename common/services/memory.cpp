#include "common/services/memory.h"

#include <algorithm>
#include <cstdlib> // defines __GLIBC__
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <sys/resource.h>
#include <unistd.h>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace kokage {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kUnknown = std::numeric_limits<std::uint64_t>::max();

/// The number at the beginning of a file; nothing for "max" and files that are not there.
std::optional<std::uint64_t> number_in(const fs::path& file) {
    std::uint64_t number = 0;
    if (std::ifstream(file) >> number)
        return number;
    return std::nullopt;
}

/// The number behind a word that begins a line, 0 if there is none.
std::uint64_t number_after(const fs::path& file, const std::string& word) {
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);) {
        std::istringstream words(line);
        std::string name;
        std::uint64_t number = 0;
        if (words >> name >> number && name == word)
            return number;
    }
    return 0;
}

std::uint64_t free_in_system(const fs::path& root) {
    const fs::path file = root / "proc/meminfo";
    const std::uint64_t kilobytes = number_after(file, "MemAvailable:");
    return kilobytes == 0 ? kUnknown : 1024 * (kilobytes + number_after(file, "SwapFree:"));
}

std::uint64_t left_of(std::uint64_t limit, std::uint64_t used) {
    return limit > used ? limit - used : 0;
}

/// Names of a control group's files, by version.
struct GroupFiles {
    const char *folder, *limit, *used, *freeable;
};
constexpr GroupFiles kVersion1 = {"sys/fs/cgroup/memory", "memory.limit_in_bytes", "memory.usage_in_bytes",
                                  "total_inactive_file"};
constexpr GroupFiles kVersion2 = {"sys/fs/cgroup", "memory.max", "memory.current", "inactive_file"};

/// Of a group and all that it is in; containers often see their own group alone, as the root.
std::uint64_t free_in_groups(const fs::path& root, const GroupFiles& files, fs::path group) {
    std::uint64_t least = kUnknown;
    for (;; group = group.parent_path()) {
        const fs::path folder = root / files.folder / group.relative_path();
        const auto limit = number_in(folder / files.limit), used = number_in(folder / files.used);
        if (limit && used) // cached pages of files count as used, but are given up first
            least =
                std::min(least, left_of(*limit, left_of(*used, number_after(folder / "memory.stat", files.freeable))));
        if (group == group.parent_path())
            return least;
    }
}

std::uint64_t free_in_control_groups(const fs::path& root) {
    std::uint64_t least = kUnknown;
    std::ifstream groups(root / "proc/self/cgroup");
    for (std::string line; std::getline(groups, line);) { // "4:cpu,memory:/path" or "0::/path"
        const std::size_t first = line.find(':'), second = line.find(':', first + 1);
        if (first == std::string::npos || second == std::string::npos)
            continue;
        const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
        const fs::path path = "/" + line.substr(second + 1);
        if (controllers == ",,")
            least = std::min(least, free_in_groups(root, kVersion2, path.lexically_normal()));
        else if (controllers.find(",memory,") != std::string::npos)
            least = std::min(least, free_in_groups(root, kVersion1, path.lexically_normal()));
    }
    return least;
}

std::uint64_t free_address_space() {
    rlimit limit{};
    if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
        return kUnknown;
    const std::uint64_t pages = number_in("/proc/self/statm").value_or(0);
    return left_of(limit.rlim_cur, pages * std::uint64_t(sysconf(_SC_PAGESIZE)));
}

} // namespace

void keep_freed_memory() {
#ifdef __GLIBC__
    mallopt(M_MMAP_MAX, 0); // blocks of their own would be given back, however large the threshold may be set
    mallopt(M_TRIM_THRESHOLD, 1 << 30);
    mallopt(M_TOP_PAD, 1 << 26);
#endif
}

std::uint64_t available_memory_bytes(const fs::path& root) {
    const std::uint64_t own = root == "/" ? free_address_space() : kUnknown;
    return std::min({own, free_in_system(root), free_in_control_groups(root)});
}

std::uint64_t peak_memory_bytes() {
    if (const std::uint64_t kilobytes = number_after("/proc/self/status", "VmHWM:"))
        return 1024 * kilobytes;
    rusage usage{}; // on Linux it has the parent's in it
    getrusage(RUSAGE_SELF, &usage);
    return 1024 * std::uint64_t(usage.ru_maxrss);
}

} // namespace kokage
