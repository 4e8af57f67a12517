#pragma once
// Files of our own that keep between runs what took long to compute: a checked header, then arrays as they lie in
// memory. Little-endian:
//
//     8 bytes   which kind of file
//     u64       version of the kind
//     u64       identity: a hash of whatever the arrays were computed from
//     u64       n, the number of arrays
//     u64       byte_hash of all the rest
//     n x u64   bytes of each array
//     the arrays, each followed by zeros up to a multiple of 8 bytes
//
// Whatever is read has been checked: no file that is cut off, altered, of another kind or version, or made for
// something else gets through. Against a stranger who can compute checksums, the reader checks its arrays' values.
#include "common/services/large_vector.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace kokage {

/// What is the same in all files of a kind, and the words for messages about them.
struct CheckedFileKind {
    std::array<char, 8> magic;
    std::uint64_t version;     ///< to be raised whenever the arrays or the way they are computed change
    std::string_view name;     ///< "weight table"
    std::string_view made_for; ///< what differs where identities do: "a map of another size, lobe or threshold"
};

/// A hash of what a file's arrays were computed from, put together piece by piece.
class FileIdentity {
  public:
    void add(std::span<const std::byte> bytes);
    /// A type without padding, whose bytes are its value.
    template <class T>
    void add_value(const T& value) {
        static_assert(std::has_unique_object_representations_v<T> || std::is_floating_point_v<T>);
        add(std::as_bytes(std::span(&value, 1)));
    }
    std::uint64_t value() const { return hash_; }

  private:
    std::uint64_t hash_ = 0;
};

/// Writes the arrays' bytes (`std::as_bytes(std::span(array))`), whole or not at all. Throws InputError where that
/// can't be done.
void write_checked_file(const std::filesystem::path& path, const CheckedFileKind& kind, std::uint64_t identity,
                        std::span<const std::span<const std::byte>> arrays);

/// A file that was read and checked.
class CheckedFile {
  public:
    /// Throws InputError, one line with the kind's name, the path and what to do: not a file or unreadable, another
    /// kind or version, truncated, altered, longer than `most_bytes`, or of another identity (nullopt: any will do).
    /// The header is checked before memory is taken, and no more is taken than the file is long.
    CheckedFile(const std::filesystem::path& path, const CheckedFileKind& kind, std::optional<std::uint64_t> identity,
                std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max());

    std::uint64_t identity() const { return identity_; }
    std::size_t arrays() const { return places_.size(); }
    /// Array `index` as it was written, valid as long as this object. Throws InputError where the file has no such
    /// array or its bytes are no whole number of T.
    template <class T>
    std::span<const T> array(std::size_t index) const {
        static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= 8);
        const std::span<const std::byte> bytes = array_bytes(index, sizeof(T));
        return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
    }
    /// The same, copied.
    template <class T>
    std::vector<T> copied(std::size_t index) const {
        const std::span<const T> values = array<T>(index);
        return {values.begin(), values.end()};
    }
    /// Throws InputError "<name> '<path>': was altered: <why>; delete it, and it is made again".
    [[noreturn]] void refuse_altered(const std::string& why) const;

  private:
    std::span<const std::byte> array_bytes(std::size_t index, std::size_t element_bytes) const;

    std::string name_; ///< "weight table 'x.table': "
    std::uint64_t identity_ = 0;
    struct Place {
        std::size_t begin, bytes;
    };
    std::vector<Place> places_;
    LargeVector<std::byte> bytes_;
};

} // namespace kokage
