#include "viewer/scene/data_folder.h"

#include "common/services/error.h"

namespace kokage {
namespace fs = std::filesystem;

void add_data_option(CLI::App& app, fs::path& data, const std::string& what) {
    app.add_option("--data", data, "A folder in which (and in whose env and trees) " + what + " looked for too")
        ->type_name("FOLDER")
        ->envname("KOKAGE_DATA");
}

void find_in_data(const fs::path& data, const std::vector<std::string*>& names) {
    if (data.empty())
        return;
    std::error_code ignored;
    if (!fs::is_directory(data, ignored))
        throw InputError("--data (or KOKAGE_DATA): there is no folder '" + data.string() + "'");
    for (std::string* name : names) {
        if (name->empty() || fs::exists(*name, ignored) || fs::path(*name).is_absolute())
            continue;
        for (const fs::path& folder : {data, data / "env", data / "trees"})
            if (fs::is_regular_file(folder / *name, ignored)) {
                *name = (folder / *name).string();
                break;
            }
    }
}

} // namespace kokage
