#include "viewer/scene/data_folder.h"

#include "common/services/error.h"

#include <CLI/CLI.hpp>

namespace kokage {
namespace fs = std::filesystem;

void add_data_option(CLI::App& app, fs::path& data, const std::string& what) {
    app.add_option("--data", data,
                   "A folder in which (and in whose env, trees, objects and textures) " + what + " looked for too")
        ->type_name("FOLDER")
        ->envname("KOKAGE_DATA");
}

std::vector<fs::path> folders_of_data(const fs::path& data) {
    if (data.empty())
        return {};
    std::error_code ignored;
    if (!fs::is_directory(data, ignored))
        throw InputError("--data (or KOKAGE_DATA): there is no folder '" + data.string() + "'");
    return {data, data / "env", data / "trees", data / "objects", data / "textures"};
}

std::string looked_for_in(const std::string& name, const fs::path& data) {
    if (fs::path(name).is_absolute())
        return "";
    return data.empty() ? "; it was looked for here alone: --data FOLDER (or KOKAGE_DATA) tells where else"
                        : "; it was looked for here, in '" + data.string() +
                              "' and in that folder's env, trees, objects and textures";
}

void find_in_data(const fs::path& data, const std::vector<std::string*>& names) {
    const std::vector<fs::path> folders = folders_of_data(data);
    std::error_code ignored;
    for (std::string* name : names) {
        if (name->empty() || fs::exists(*name, ignored) || fs::path(*name).is_absolute())
            continue;
        for (const fs::path& folder : folders)
            if (fs::is_regular_file(folder / *name, ignored)) {
                *name = (folder / *name).string();
                break;
            }
    }
}

} // namespace kokage
