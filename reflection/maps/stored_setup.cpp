#include "reflection/maps/stored_setup.h"
#include "common/services/error.h"
#include "common/services/output_file.h"
#include "common/services/random.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <fstream>

namespace kokage {
namespace {

static_assert(std::endian::native == std::endian::little, "the file's numbers are little-endian");

constexpr std::array<char, 8> kMagic = {'K', 'o', 'k', 'a', 'g', 'e', 'S', 'H'};
constexpr std::uint64_t kVersion = 1;

struct Header {
    std::array<char, 8> magic = kMagic;
    std::uint64_t version = kVersion, identity = 0;
    std::uint64_t floats = 0;
    std::uint64_t hash = 0; ///< of the floats and of what stands above
};
static_assert(sizeof(Header) == 40);

/// Four sums side by side, for speed.
std::uint64_t hash_of(std::span<const std::byte> bytes) {
    std::array<std::uint64_t, 4> sums = {1, 2, 3, 4};
    std::size_t at = 0;
    for (; at + 32 <= bytes.size(); at += 32)
        for (std::size_t k = 0; k < 4; ++k) {
            std::uint64_t word;
            std::memcpy(&word, bytes.data() + at + 8 * k, sizeof word);
            sums[k] = (std::rotl(sums[k], 29) ^ word) * 0x9e3779b97f4a7c15ull;
        }
    for (std::size_t k = 0; at < bytes.size(); ++at, ++k)
        sums[k % 4] = (std::rotl(sums[k % 4], 29) ^ std::uint64_t(bytes[at])) * 0x9e3779b97f4a7c15ull;
    std::uint64_t hash = bytes.size();
    for (const std::uint64_t sum : sums)
        hash = hash64(hash ^ sum);
    return hash;
}

std::uint64_t hash_of_header(Header header) {
    header.hash = 0;
    return hash_of(std::as_bytes(std::span(&header, 1)));
}

} // namespace

void SetupIdentity::add(std::span<const std::byte> bytes) {
    hash_ = hash64(hash_ ^ hash_of(bytes));
}

void write_setup(const std::filesystem::path& path, std::uint64_t identity,
                 std::span<const std::span<const float>> arrays) {
    Header header;
    header.identity = identity;
    for (const std::span<const float> array : arrays)
        header.floats += array.size();
    header.hash = hash_of_header(header);
    std::vector<float> all;
    all.reserve(header.floats);
    for (const std::span<const float> array : arrays)
        all.insert(all.end(), array.begin(), array.end());
    header.hash ^= hash_of(std::as_bytes(std::span(all)));
    OutputFile file(path);
    file.write(std::as_bytes(std::span(&header, 1)));
    file.write(std::as_bytes(std::span(all)));
    file.commit();
}

std::vector<float> read_setup(const std::filesystem::path& path, std::uint64_t identity) {
    const std::string name = "stored set-up '" + path.string() + "': ", again = "; delete it, and it is made again";
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    if (!file)
        throw InputError(name + "can't be read: check that it is a file and readable");
    const std::uint64_t size = std::uint64_t(std::max<std::streamoff>(file.tellg(), 0));
    file.seekg(0);
    Header header;
    if (size < sizeof header || !file.read(reinterpret_cast<char*>(&header), sizeof header) || header.magic != kMagic)
        throw InputError(name + "is no set-up of the spectral baker; give the name of one, or of a file that is not "
                                "there yet");
    if (header.version != kVersion)
        throw InputError(name + "is of version " + std::to_string(header.version) + ", this program writes version " +
                         std::to_string(kVersion) + again);
    const std::uint64_t payload = size - sizeof header;
    if (payload % sizeof(float) != 0 || payload / sizeof(float) != header.floats)
        throw InputError(name + (payload / sizeof(float) < header.floats ? "is truncated: " : "was altered: ") +
                         std::to_string(payload) + " bytes of " + std::to_string(header.floats) + " numbers" + again);
    std::vector<float> all(header.floats);
    if (!all.empty() && !file.read(reinterpret_cast<char*>(all.data()), std::streamsize(payload)))
        throw InputError(name + "can't be read to its end" + again);
    if ((hash_of_header(header) ^ hash_of(std::as_bytes(std::span(all)))) != header.hash)
        throw InputError(name + "was altered: its checksum is wrong" + again);
    if (header.identity != identity)
        throw InputError(name + "was made for a map or images of another size, lobe, range or tolerance" + again +
                         " for this one");
    return all;
}

} // namespace kokage
