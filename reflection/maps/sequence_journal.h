#pragma once
// Which frames of a sequence are finished. Inside of bake_sequence alone.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <unordered_map>

namespace kokage {

class SequenceJournal {
  public:
    /// Reads what is there, or begins anew. A last line that was cut off when a run was killed is dropped. Throws
    /// InputError for another identity, or what is no journal.
    SequenceJournal(const std::filesystem::path& path, const std::string& identity);

    /// True if the frame's map is there as the journal says, of this image as it is now.
    bool has(std::uint64_t frame, const std::filesystem::path& input, const std::filesystem::path& output) const;
    void add_finished(std::uint64_t frame, const std::filesystem::path& input, const std::filesystem::path& output);
    void add_broken(std::uint64_t frame, const std::filesystem::path& input, const std::string& why);

  private:
    void read(const std::string& identity);
    void append(const std::string& line);

    std::filesystem::path path_;
    std::unordered_map<std::uint64_t, std::uint64_t> finished_; ///< frame -> hash of its line's facts
    std::ofstream stream_;
};

} // namespace kokage
