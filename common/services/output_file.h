#pragma once
// Files appear whole or not at all: they are written beside their final place and renamed when they are complete.
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <span>
#include <string_view>

namespace kokage {

/// A file in the making. Write to stream(), or let a library write to temporary_path(); then call commit().
/// Destroyed without commit() (an exception, Ctrl-C unwinding through Stopped), it removes what it wrote, and a file
/// that was at the final path before is untouched. A symbolic link at the final path is followed; a device (/dev/null)
/// is written, not replaced.
class OutputFile {
  public:
    /// Creates an empty temporary file in the folder of `path`. Throws InputError if that folder is missing or not
    /// writable, or if `path` is a folder.
    explicit OutputFile(const std::filesystem::path& path);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    /// Where it will be, as the user named it.
    const std::filesystem::path& path() const { return path_; }
    /// Where it is written until commit(); has the same extension as path().
    const std::filesystem::path& temporary_path() const { return temporary_path_; }
    /// Binary stream on the temporary file, opened by the first call.
    std::ostream& stream();
    void write(std::span<const std::byte> bytes);
    void write(std::string_view text);

    /// Closes the stream and puts the file in its place. Throws InputError if anything could not be written (disk
    /// full).
    void commit();

  private:
    std::filesystem::path path_, target_, temporary_path_;
    std::ofstream stream_;
    bool copy_to_device_ = false, committed_ = false;
};

/// Writes a whole file in one go.
void write_file(const std::filesystem::path& path, std::string_view contents);
void write_file(const std::filesystem::path& path, std::span<const unsigned char> bytes);

} // namespace kokage
