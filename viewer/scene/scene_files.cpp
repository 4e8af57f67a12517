#include "viewer/scene/scene_files.h"
#include "common/services/named_file.h"
#include "common/services/nearest_word.h"
#include "viewer/scene/data_folder.h"

#include <algorithm>

namespace kokage {
namespace fs = std::filesystem;
namespace {

std::string listed(std::initializer_list<const char*> endings) {
    std::string text;
    for (const char* ending : endings)
        text += (text.empty() ? "" : ", ") + std::string(ending);
    return text;
}

} // namespace

SceneFiles::SceneFiles(const fs::path& scene, const fs::path& data) : scene_(scene) {
    folders_.push_back(scene.parent_path());
    for (fs::path& folder : folders_of_data(data))
        folders_.push_back(std::move(folder));
}

fs::path SceneFiles::find(const JsonReader& name, std::initializer_list<const char*> endings) const {
    const std::string text = name.text();
    const std::string ending = lower_ending(text);
    std::error_code ignored;
    for (const fs::path& folder : folders_) {
        const fs::path path = folder / text;
        if (fs::is_directory(path, ignored))
            name.fail("'" + shown_name(text) + "' is a folder; give a file (" + listed(endings) + ")");
    }
    if (std::none_of(endings.begin(), endings.end(), [&](const char* known) { return ending == known; }))
        name.fail("'" + shown_name(text) + "' " + (ending.empty() ? "has no ending" : "ends in " + shown_name(ending)) +
                  "; give a file of one of these endings: " + listed(endings));
    for (const fs::path& folder : folders_) {
        const fs::path path = folder / text;
        if (fs::exists(path, ignored) && fs::equivalent(path, scene_, ignored))
            name.fail("'" + shown_name(text) + "' is this scene itself (cyclic): a scene can't be within a scene");
        if (fs::is_regular_file(path, ignored))
            return path;
        if (fs::exists(path, ignored))
            name.fail("'" + shown_name(text) + "' is no regular file");
    }
    fail_to_find(name, text, listed(endings));
}

void SceneFiles::fail_to_find(const JsonReader& name, const std::string& text, const std::string& endings) const {
    constexpr std::size_t kMostNames = 10000;
    const fs::path inner = fs::path(text).parent_path();
    std::vector<std::string> stems, names;
    for (const fs::path& folder : folders_) {
        std::error_code error;
        const fs::path place = folder / inner;
        for (fs::directory_iterator at(place.empty() ? "." : place, error), end;
             !error && at != end && names.size() < kMostNames; at.increment(error))
            if (endings.find(lower_ending(at->path())) != std::string::npos && !lower_ending(at->path()).empty()) {
                stems.push_back(at->path().stem().string());
                names.push_back((inner / at->path().filename()).string());
            }
    }
    const auto stem = nearest_word(fs::path(text).stem().string(), stems);
    const auto near =
        stem ? std::optional(names[std::size_t(std::find(stems.begin(), stems.end(), *stem) - stems.begin())])
             : std::nullopt;
    const std::string beside = folders_.front().empty() ? "." : folders_.front().string();
    name.fail("there is no file '" + shown_name(text) + "' beside the scene (in '" + beside + "')" +
              (folders_.size() > 1 ? " nor in the data folder '" + folders_[1].string() + "'" : "") +
              (near                  ? "; did you mean '" + shown_name(*near) + "'?"
               : folders_.size() > 1 ? "; put it there, or give its whole path"
                                     : "; put it there, give its whole path, or tell where by --data FOLDER"));
}

} // namespace kokage
