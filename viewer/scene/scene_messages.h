#pragma once
// Where in a scene file something is that is wrong or doubtful. Private to viewer/scene.
#include "common/services/error.h"

#include <filesystem>
#include <string>
#include <utility>

namespace kokage {

class SceneMessages {
  public:
    /// `file`: empty for "just a tree", which no file describes.
    explicit SceneMessages(std::filesystem::path file) : file_(std::move(file)) {}

    bool has_file() const { return !file_.empty(); }
    /// "garden.json: TEXT".
    std::string in_file(const std::string& text) const { return has_file() ? file_.string() + ": " + text : text; }
    /// "garden.json: /trees/1: WHAT".
    [[noreturn]] void fail(const std::string& pointer, const std::string& what) const {
        throw InputError(in_file((pointer.empty() ? "" : pointer + ": ") + what));
    }
    /// Does the work; what it complains of is said to be there.
    template <typename Work>
    auto told_at(const std::string& pointer, Work&& work) const {
        try {
            return work();
        } catch (const InputError& error) {
            fail(pointer, error.what());
        }
    }

  private:
    std::filesystem::path file_;
};

} // namespace kokage
