// Weight tables in files: a checked header, then the arrays as they lie in memory (little-endian).
#include "common/services/error.h"
#include "common/services/named_file.h"
#include "common/services/output_file.h"
#include "common/services/random.h"
#include "reflection/maps/weight_table.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace kokage {

namespace {

static_assert(std::endian::native == std::endian::little, "the file's numbers are little-endian");

constexpr std::array<char, 8> kMagic = {'K', 'o', 'k', 'a', 'g', 'e', 'W', 'T'};
constexpr std::uint64_t kVersion = 1;

struct Header {
    std::array<char, 8> magic = kMagic;
    std::uint64_t version = kVersion;
    std::uint64_t identity = 0; ///< table_identity()
    std::uint64_t rows = 0, texels = 0, entries = 0, weights = 0;
    std::uint64_t used[kDomeLevels] = {};
    std::uint64_t payload_hash = 0;
};
static_assert(sizeof(Header) == 96);

std::uint64_t hash_of(std::span<const std::byte> bytes) {
    std::uint64_t hash = bytes.size();
    while (!bytes.empty()) {
        std::uint64_t word = 0;
        const std::size_t count = std::min(bytes.size(), sizeof word);
        std::memcpy(&word, bytes.data(), count);
        hash = hash64(hash ^ word);
        bytes = bytes.subspan(count);
    }
    return hash;
}

/// Of the header too, but for the field that holds it.
std::uint64_t hash_of_file(Header header, std::span<const std::byte> payload) {
    header.payload_hash = 0;
    return hash64(hash_of(std::as_bytes(std::span(&header, 1))) ^ hash_of(payload));
}

std::uint64_t payload_bytes(const Header& header) {
    std::uint64_t bytes = (header.rows + 1) * (8 + 4) + header.rows + header.texels * 4 + header.entries * (2 + 4);
    for (std::uint64_t used : header.used)
        bytes += 2 * used;
    return bytes;
}

/// No count may be so large that their sum overflows.
bool is_sane(const Header& header) {
    constexpr std::uint64_t kMost = std::uint64_t(1) << 40;
    bool sane = header.rows < kMost && header.texels < kMost && header.entries < kMost;
    for (std::uint64_t used : header.used)
        sane = sane && used <= 65536;
    return sane;
}

} // namespace

void WeightTable::save(const std::filesystem::path& path) const {
    Header header;
    header.identity = identity_;
    header.rows = rows();
    header.texels = texels();
    header.entries = entries();
    header.weights = unshared_;
    std::vector<std::byte> payload;
    payload.reserve(bytes());
    const auto append = [&](const auto& values) {
        const std::span bytes = std::as_bytes(std::span(values));
        payload.insert(payload.end(), bytes.begin(), bytes.end());
    };
    append(starts_);
    append(member_starts_);
    append(levels_);
    append(members_);
    append(slots_);
    append(weights_);
    for (int level = 0; level < kDomeLevels; ++level) {
        header.used[level] = used_[level].size();
        append(used_[level]);
    }
    header.payload_hash = hash_of_file(header, payload);
    OutputFile file(path);
    file.write(std::as_bytes(std::span(&header, 1)));
    file.write(payload);
    file.commit();
}

WeightTable WeightTable::load(const std::filesystem::path& path, const TexelLayout& layout,
                              const TableSettings& settings) {
    const std::string again = "; delete it, and it is made again";
    const std::string name = "weight table '" + path.string() + "': ";
    const std::vector<unsigned char> file = read_file_bytes(path, settings.most_bytes + sizeof(Header));
    Header header;
    if (file.size() < sizeof header || std::memcmp(file.data(), kMagic.data(), kMagic.size()) != 0)
        throw InputError(name + "is no weight table; give the name of one, or of a file that is not there yet");
    std::memcpy(&header, file.data(), sizeof header);
    if (header.version != kVersion)
        throw InputError(name + "is of version " + std::to_string(header.version) + ", this program writes version " +
                         std::to_string(kVersion) + again);
    if (!is_sane(header) || file.size() > sizeof header + payload_bytes(header))
        throw InputError(name + "was altered: its size is not what its header says" + again);
    if (file.size() < sizeof header + payload_bytes(header))
        throw InputError(name + "is truncated: " + std::to_string(file.size()) + " of " +
                         std::to_string(sizeof header + payload_bytes(header)) + " bytes" + again);
    std::span payload = std::as_bytes(std::span(file)).subspan(sizeof header);
    if (hash_of_file(header, payload) != header.payload_hash)
        throw InputError(name + "was altered: its checksum is wrong" + again);
    if (header.identity != table_identity(layout, settings))
        throw InputError(name + "was made for a map of another size, lobe, range or threshold" + again +
                         " for this one");

    WeightTable table;
    const auto take = [&](auto& values, std::uint64_t count) {
        values.resize(count);
        const std::size_t bytes = count * sizeof(values[0]);
        if (bytes > 0)
            std::memcpy(values.data(), payload.data(), bytes);
        payload = payload.subspan(bytes);
    };
    take(table.starts_, header.rows + 1);
    take(table.member_starts_, header.rows + 1);
    take(table.levels_, header.rows);
    take(table.members_, header.texels);
    take(table.slots_, header.entries);
    take(table.weights_, header.entries);
    for (int level = 0; level < kDomeLevels; ++level)
        take(table.used_[level], header.used[level]);
    table.unshared_ = header.weights;
    table.identity_ = header.identity;
    if (!table.is_consistent())
        throw InputError(name + "was altered: it names texels or weights that it does not have" + again);
    return table;
}

/// A checksum is no proof against a stranger who can compute one, and wrong indices would read foreign memory.
bool WeightTable::is_consistent() const {
    const auto rises = [](const auto& starts, std::size_t end) {
        return starts.front() == 0 && starts.back() == end && std::is_sorted(starts.begin(), starts.end());
    };
    if (!rises(starts_, weights_.size()) || !rises(member_starts_, members_.size()))
        return false;
    for (std::size_t row = 0; row < levels_.size(); ++row) {
        if (levels_[row] >= kDomeLevels)
            return false;
        for (std::uint64_t e = starts_[row]; e < starts_[row + 1]; ++e)
            if (slots_[e] >= used_[levels_[row]].size())
                return false;
    }
    for (int level = 0; level < kDomeLevels; ++level)
        for (std::uint16_t vertex : used_[level])
            if (vertex >= dome_of_level(level).dome.directions.size())
                return false;
    return std::all_of(members_.begin(), members_.end(), [this](std::uint32_t member) {
        return member / 32 < members_.size() && member % 32 < std::uint32_t(kDomeSymmetries);
    });
}

} // namespace kokage
