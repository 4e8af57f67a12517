#include "common/services/checked_file.h"
#include "common/services/byte_hash.h"
#include "common/services/error.h"
#include "common/services/output_file.h"

#include <algorithm>
#include <bit>
#include <fstream>

namespace kokage {
namespace {

static_assert(std::endian::native == std::endian::little, "the file's numbers are little-endian");

constexpr const char* kAgain = "; delete it, and it is made again";
/// Far more than any kind has; what a damaged header says beyond is not believed.
constexpr std::uint64_t kMostArrays = 4096;
constexpr std::uint64_t kAlign = 8;

struct Header {
    std::array<char, 8> magic{};
    std::uint64_t version = 0, identity = 0, arrays = 0, hash = 0;
};
static_assert(sizeof(Header) == 40);

std::uint64_t padded(std::uint64_t bytes) {
    return (bytes + kAlign - 1) / kAlign * kAlign;
}

/// Of the header but for the hash itself, and of the arrays' sizes.
std::uint64_t hash_of(Header header, std::span<const std::uint64_t> sizes) {
    header.hash = 0;
    return byte_hash(std::as_bytes(sizes), byte_hash(std::as_bytes(std::span(&header, 1))));
}

std::string described(const std::filesystem::path& path, const CheckedFileKind& kind) {
    return std::string(kind.name) + " '" + path.string() + "': ";
}

/// The file's header and the arrays' sizes, which together make the file exactly as long as it is.
class HeaderReader {
  public:
    HeaderReader(const std::filesystem::path& path, const CheckedFileKind& kind, std::uint64_t most_bytes)
        : name_(described(path, kind)) {
        std::error_code ignored;
        if (std::filesystem::is_regular_file(path, ignored))
            file_.open(path, std::ios::binary | std::ios::ate);
        if (!file_.is_open() || !file_)
            throw InputError(name_ + "can't be read: check that it is a file and readable");
        length_ = std::uint64_t(std::max<std::streamoff>(file_.tellg(), 0));
        file_.seekg(0);
        if (length_ < sizeof header || !read(&header, sizeof header) || header.magic != kind.magic)
            throw InputError(name_ + "is no " + std::string(kind.name) +
                             "; give the name of one, or of a file that is not there yet");
        if (header.version != kind.version)
            throw InputError(name_ + "is of version " + std::to_string(header.version) +
                             ", this program writes version " + std::to_string(kind.version) + kAgain);
        if (header.arrays > kMostArrays)
            throw InputError(name_ + "was altered: it can't have " + std::to_string(header.arrays) + " arrays" +
                             kAgain);
        if (length_ > most_bytes)
            throw InputError(name_ + "has " + std::to_string(length_) + " bytes where at most " +
                             std::to_string(most_bytes) + " are expected" + kAgain);
        read_sizes();
    }
    /// From where the file is; false where it ends before.
    bool read(void* to, std::size_t bytes) {
        return bytes == 0 || file_.read(static_cast<char*>(to), std::streamsize(bytes)).good();
    }

    Header header;
    std::vector<std::uint64_t> sizes; ///< of the arrays, in bytes

  private:
    void read_sizes() {
        const std::uint64_t first = sizeof header + header.arrays * sizeof(std::uint64_t);
        sizes.resize(header.arrays);
        std::uint64_t expected = first;
        if (length_ >= first && read(sizes.data(), sizes.size() * sizeof(std::uint64_t)))
            for (const std::uint64_t size : sizes) {
                if (size > std::numeric_limits<std::uint64_t>::max() / 2 / kMostArrays)
                    throw InputError(name_ + "was altered: its size is not what its header says" + kAgain);
                expected += padded(size);
            }
        if (length_ < expected)
            throw InputError(name_ + "is truncated: " + std::to_string(length_) + " of at least " +
                             std::to_string(expected) + " bytes" + kAgain);
        if (length_ > expected)
            throw InputError(name_ + "was altered: its size is not what its header says" + kAgain);
    }

    std::string name_;
    std::ifstream file_;
    std::uint64_t length_ = 0;
};

} // namespace

void FileIdentity::add(std::span<const std::byte> bytes) {
    hash_ = byte_hash(bytes, hash_);
}

void write_checked_file(const std::filesystem::path& path, const CheckedFileKind& kind, std::uint64_t identity,
                        std::span<const std::span<const std::byte>> arrays) {
    Header header{kind.magic, kind.version, identity, arrays.size(), 0};
    std::vector<std::uint64_t> sizes;
    for (const std::span<const std::byte> array : arrays)
        sizes.push_back(array.size());
    std::uint64_t hash = hash_of(header, sizes);
    for (const std::span<const std::byte> array : arrays)
        hash = byte_hash(array, hash);
    header.hash = hash;
    constexpr std::array<std::byte, kAlign> zeros{};
    OutputFile file(path);
    file.write(std::as_bytes(std::span(&header, 1)));
    file.write(std::as_bytes(std::span(sizes)));
    for (const std::span<const std::byte> array : arrays) {
        file.write(array);
        file.write(std::span(zeros).first(std::size_t(padded(array.size()) - array.size())));
    }
    file.commit();
}

CheckedFile::CheckedFile(const std::filesystem::path& path, const CheckedFileKind& kind,
                         std::optional<std::uint64_t> identity, std::uint64_t most_bytes)
    : name_(described(path, kind)) {
    HeaderReader reader(path, kind, most_bytes);
    std::size_t end = 0;
    for (const std::uint64_t size : reader.sizes) {
        places_.push_back({end, std::size_t(size)});
        end += std::size_t(padded(size));
    }
    bytes_.resize(end);
    if (!reader.read(bytes_.data(), bytes_.size()))
        throw InputError(name_ + "can't be read to its end" + kAgain);
    std::uint64_t hash = hash_of(reader.header, reader.sizes);
    for (const Place& place : places_) {
        const std::span<const std::byte> array(bytes_.data() + place.begin, place.bytes);
        hash = byte_hash(array, hash);
        const std::size_t padding_begin = place.begin + place.bytes, padding_end = place.begin + padded(place.bytes);
        if (std::any_of(bytes_.data() + padding_begin, bytes_.data() + padding_end,
                        [](std::byte byte) { return byte != std::byte(0); }))
            refuse_altered("there is something between its arrays");
    }
    if (hash != reader.header.hash)
        refuse_altered("its checksum is wrong");
    identity_ = reader.header.identity;
    if (identity && identity_ != *identity)
        throw InputError(name_ + "was made for " + std::string(kind.made_for) + kAgain + " for this one");
}

std::span<const std::byte> CheckedFile::array_bytes(std::size_t index, std::size_t element_bytes) const {
    if (index >= places_.size())
        refuse_altered("it has " + std::to_string(places_.size()) + " arrays, and one more is needed");
    const Place& place = places_[index];
    if (place.bytes % element_bytes != 0)
        refuse_altered("the " + std::to_string(place.bytes) + " bytes of array " + std::to_string(index) +
                       " are no whole number of values");
    return {bytes_.data() + place.begin, place.bytes};
}

void CheckedFile::refuse_altered(const std::string& why) const {
    throw InputError(name_ + "was altered: " + why + kAgain);
}

} // namespace kokage
