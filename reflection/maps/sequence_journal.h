#pragma once
// Which frames of a sequence are finished. Inside of bake_sequence alone.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <unordered_map>

namespace kokage {

/// An image file as it is at a time; two of other bytes or age differ.
struct ImageFacts {
    std::filesystem::path file;
    std::uint64_t bytes = 0, time = 0; ///< 0 if it is not there
};
ImageFacts facts_of_image(const std::filesystem::path& file);

class SequenceJournal {
  public:
    /// Reads what is there, or begins anew. A last line that was cut off when a run was killed is dropped. Throws
    /// InputError for another identity, or what is no journal.
    SequenceJournal(const std::filesystem::path& path, const std::string& identity);

    /// True if an earlier run finished the frame and its map is there as the journal says, of this very image. `file`:
    /// where the map lies now, `output`: where it was written.
    bool has(std::uint64_t frame, const ImageFacts& image, const std::filesystem::path& output,
             const std::filesystem::path& file) const;
    /// `image`: as it was before it was read, so that one that changed since is told by its facts. Frames that are
    /// added are not found by has(), which may be asked meanwhile.
    void add_finished(std::uint64_t frame, const ImageFacts& image, const std::filesystem::path& output);
    void add_broken(std::uint64_t frame, const ImageFacts& image, const std::string& why);

  private:
    void read(const std::string& identity);
    void append(const std::string& line);

    std::filesystem::path path_;
    std::unordered_map<std::uint64_t, std::uint64_t> finished_; ///< before: frame -> hash of its line's facts
    std::ofstream stream_;
};

} // namespace kokage
