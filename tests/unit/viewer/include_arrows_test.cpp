// Includes run one way: common <- trees <- foliage; common <- reflection; all <- viewer.
#include "tests/support/program_run.h"

#include <map>
#include <regex>

namespace kokage {
namespace {
namespace fs = std::filesystem;

/// What the files of a room may include of ours, by the beginning of the path.
const std::map<std::string, std::vector<std::string>>& arrows() {
    static const std::map<std::string, std::vector<std::string>> rooms = {
        {"common", {"common/"}},
        {"trees", {"common/", "trees/"}},
        {"foliage", {"common/", "trees/", "foliage/"}},
        {"reflection", {"common/", "reflection/"}},
        {"viewer", {"common/", "trees/", "foliage/", "reflection/", "viewer/", "tests/benchmark/"}},
        {"tests/benchmark", {"common/", "trees/", "foliage/", "reflection/", "viewer/scene/", "tests/benchmark/"}}};
    return rooms;
}

/// The includes of a text that a room may not have: another room's, or a path that does not begin at the root.
std::vector<std::string> wrong_includes(const std::string& text, const std::vector<std::string>& allowed) {
    static const std::regex include("(?:^|\n)[ \t]*#[ \t]*include[ \t]*([\"<])([^\">]+)[\">]");
    std::vector<std::string> wrong;
    for (std::sregex_iterator found(text.begin(), text.end(), include), end; found != end; ++found) {
        const std::string path = (*found)[2];
        const auto begins = [&](const std::string& folder) { return path.rfind(folder, 0) == 0; };
        const bool of_a_room =
            std::any_of(arrows().begin(), arrows().end(), [&](const auto& room) { return begins(room.first + "/"); });
        // <...> is for libraries; "..." is for ours, from the repository's root.
        if (((*found)[1] == "\"" || of_a_room) && std::none_of(allowed.begin(), allowed.end(), begins))
            wrong.push_back(path);
    }
    return wrong;
}

TEST(IncludeArrows, RunOneWay) {
    const fs::path root = fs::path(KOKAGE_TESTS_FOLDER).parent_path();
    for (const auto& [room, allowed] : arrows()) {
        int files = 0;
        for (const auto& entry : fs::recursive_directory_iterator(root / room)) {
            const std::string ending = entry.path().extension().string();
            if (ending != ".h" && ending != ".cpp")
                continue;
            ++files;
            for (const std::string& path : wrong_includes(read_text(entry.path()), allowed))
                ADD_FAILURE() << fs::relative(entry.path(), root) << " must not include \"" << path << '"';
        }
        EXPECT_GT(files, 5) << room;
    }
}

TEST(IncludeArrows, WrongOnesAreSeen) {
    const std::vector<std::string>& reflection = arrows().at("reflection");
    EXPECT_TRUE(wrong_includes("#pragma once\n#include \"common/types.h\"\n#include <vector>\n", reflection).empty());
    using Paths = std::vector<std::string>;
    EXPECT_EQ(wrong_includes("#include \"trees/tree.h\"\n", reflection), Paths{"trees/tree.h"});
    EXPECT_EQ(wrong_includes("//\n # include <foliage/method.h>\n", reflection), Paths{"foliage/method.h"});
    EXPECT_EQ(wrong_includes("#include \"../trees/tree.h\"\n#include \"sampling.h\"\n", reflection),
              (Paths{"../trees/tree.h", "sampling.h"}));
}

} // namespace
} // namespace kokage
