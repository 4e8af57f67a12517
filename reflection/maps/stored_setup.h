#pragma once
// Prepared tables in a file: a checked header, then arrays of floats as they lie in memory (little-endian).
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace kokage {

/// A hash that tells one set-up from another, put together from what it was made for.
class SetupIdentity {
  public:
    void add(std::span<const std::byte> bytes);
    template <class T>
    void add_value(const T& value) {
        add(std::as_bytes(std::span(&value, 1)));
    }
    std::uint64_t value() const { return hash_; }

  private:
    std::uint64_t hash_ = 0;
};

/// Writes `arrays` one after another. Throws InputError where that can't be done.
void write_setup(const std::filesystem::path& path, std::uint64_t identity,
                 std::span<const std::span<const float>> arrays);

/// All arrays, one after another. Throws InputError, with the path, if the file is no set-up, of another version,
/// truncated, altered, or made for something else than `identity`.
std::vector<float> read_setup(const std::filesystem::path& path, std::uint64_t identity);

} // namespace kokage
