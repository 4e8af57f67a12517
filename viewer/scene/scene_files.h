#pragma once
// Files that a scene file names.
#include "common/services/json_reader.h"

#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

namespace kokage {

class SceneFiles {
  public:
    /// Looks beside `scene`, then in the folder `data` (may be empty). Throws InputError if that is no folder.
    SceneFiles(const std::filesystem::path& scene, const std::filesystem::path& data);

    /// The file of that name, which must have one of the endings. Fails with the name's place if there is none
    /// (the nearest name of those that are there is told), or if it is a folder or the scene itself.
    std::filesystem::path find(const JsonReader& name, std::initializer_list<const char*> endings) const;

  private:
    [[noreturn]] void fail_to_find(const JsonReader& name, const std::string& text, const std::string& endings) const;

    std::filesystem::path scene_;
    std::vector<std::filesystem::path> folders_; ///< the scene's own first
};

} // namespace kokage
