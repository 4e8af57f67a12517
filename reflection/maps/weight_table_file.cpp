// Weight tables in files (common/services/checked_file.h).
#include "common/services/checked_file.h"
#include "reflection/maps/weight_table.h"

#include <algorithm>

namespace kokage {

namespace {

constexpr CheckedFileKind kWeightTable{
    {'K', 'o', 'k', 'a', 'g', 'e', 'W', 'T'}, 2, "weight table", "a map of another size, lobe, range or threshold"};

} // namespace

void WeightTable::save(const std::filesystem::path& path) const {
    std::vector<std::span<const std::byte>> arrays;
    const auto add = [&](const auto& values) { arrays.push_back(std::as_bytes(std::span(values))); };
    add(starts_);
    add(member_starts_);
    add(levels_);
    add(members_);
    add(slots_);
    add(weights_);
    for (const std::vector<std::uint16_t>& used : used_)
        add(used);
    arrays.push_back(std::as_bytes(std::span(&unshared_, 1)));
    write_checked_file(path, kWeightTable, identity_, arrays);
}

WeightTable WeightTable::load(const std::filesystem::path& path, const TexelLayout& layout,
                              const TableSettings& settings) {
    constexpr std::uint64_t kSmallArrays = 1 << 20; // header, used_
    const CheckedFile file(path, kWeightTable, table_identity(layout, settings), settings.most_bytes + kSmallArrays);
    WeightTable table;
    table.starts_ = file.copied<std::uint64_t>(0);
    table.member_starts_ = file.copied<std::uint32_t>(1);
    table.levels_ = file.copied<std::uint8_t>(2);
    table.members_ = file.copied<std::uint32_t>(3);
    table.slots_ = file.copied<std::uint16_t>(4);
    table.weights_ = file.copied<float>(5);
    std::size_t next = 6;
    for (std::vector<std::uint16_t>& used : table.used_)
        used = file.copied<std::uint16_t>(next++);
    const std::span<const std::uint64_t> unshared = file.array<std::uint64_t>(next);
    table.identity_ = file.identity();
    if (unshared.size() != 1 || table.texels() != layout.size() || !table.is_consistent())
        file.refuse_altered("it names texels or weights that it does not have");
    table.unshared_ = unshared.front();
    return table;
}

/// A checksum is no proof against a stranger who can compute one, and wrong indices would read foreign memory.
bool WeightTable::is_consistent() const {
    const auto rises = [this](const auto& starts, std::size_t end) {
        return starts.size() == rows() + 1 && starts.front() == 0 && starts.back() == end &&
               std::is_sorted(starts.begin(), starts.end());
    };
    if (slots_.size() != weights_.size() || !rises(starts_, weights_.size()) || !rises(member_starts_, members_.size()))
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
