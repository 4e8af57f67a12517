#include "viewer/scene/output_check.h"
#include "common/services/error.h"
#include "common/services/named_file.h"
#include "common/services/output_file.h"

#include <algorithm>
#include <vector>

namespace kokage {
namespace fs = std::filesystem;

void check_output(const fs::path& path, std::string_view what, std::initializer_list<std::string_view> endings) {
    const std::string ending = lower_ending(path);
    std::error_code ignored;
    if (!fs::is_directory(path, ignored) && std::find(endings.begin(), endings.end(), ending) == endings.end()) {
        std::string known;
        for (std::string_view one : endings)
            known += (known.empty() ? "" : ", ") + std::string(one);
        throw InputError(std::string(what) + " can't be '" + path.string() + "': " +
                         (ending.empty() ? "the name has no ending" : "the ending " + ending + " is not known") +
                         (endings.size() == 1 ? "; give " : "; give one of ") + known);
    }
    const OutputFile probe(path); // creates a temporary file there and takes it away again
}

void check_distinct(std::initializer_list<fs::path> files) {
    std::vector<fs::path> seen;
    for (const fs::path& file : files) {
        if (file.empty())
            continue;
        std::error_code ignored;
        const fs::path place = fs::weakly_canonical(fs::absolute(file), ignored);
        if (std::find(seen.begin(), seen.end(), place) != seen.end())
            throw InputError("'" + file.string() +
                             "' is named twice, and would be overwritten; give each file its own name");
        seen.push_back(place);
    }
}

} // namespace kokage
