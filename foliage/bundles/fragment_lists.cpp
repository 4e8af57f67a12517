#include "common/services/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "foliage/bundles/fragment_lists.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "foliage/bundles/fragment_lists.h"

#include "common/services/error.h"

#include <algorithm>
#include <array>
#include <utility>

HWY_BEFORE_NAMESPACE();
namespace kokage::bundles::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using KeyTag = hn::CappedTag<std::uint32_t, FragmentLists::kGroup>;
using KeyVec = hn::Vec<KeyTag>;
constexpr std::size_t kGroup = FragmentLists::kGroup;
constexpr std::uint32_t kLast = 0xffffffffu; ///< behind all keys
constexpr std::size_t kMostSortedTogether = 16;

struct Comparator {
    std::uint8_t low, high;
};

/// Calls compare(i, j) for a network that sorts `count` values: merge exchange (Knuth, The Art of Computer Programming
/// 3, algorithm 5.2.2M).
template <class Compare>
constexpr void for_each_comparator(int count, Compare&& compare) {
    int top = 1;
    while (2 * top < count)
        top *= 2;
    for (int p = top; p > 0; p /= 2)
        for (int q = top, r = 0, d = p;; d = q - p, q /= 2, r = p) {
            for (int i = 0; i + d < count; ++i)
                if ((i & p) == r)
                    compare(i, i + d);
            if (q == p)
                break;
        }
}

template <int Count>
constexpr auto make_network() {
    constexpr int size = [] {
        int comparators = 0;
        for_each_comparator(Count, [&](int, int) { ++comparators; });
        return comparators;
    }();
    std::array<Comparator, std::size_t(size)> network{};
    std::size_t next = 0;
    for_each_comparator(Count, [&](int low, int high) { network[next++] = {std::uint8_t(low), std::uint8_t(high)}; });
    return network;
}

/// Sorts the lists of the pixels of one vector, none longer than Count; `rows` are as many as the longest has.
template <int Count>
HWY_INLINE void SortLists(KeyVec lengths, std::size_t rows, std::uint32_t* keys) {
    constexpr auto network = make_network<Count>();
    const KeyTag d;
    KeyVec key[Count];
    for (std::size_t i = 0; i < Count; ++i) {
        const auto there = hn::Lt(hn::Set(d, std::uint32_t(i)), lengths);
        key[i] = hn::IfThenElse(there, hn::LoadU(d, keys + i * kGroup), hn::Set(d, kLast));
    }
    [&]<std::size_t... Step>(std::index_sequence<Step...>) {
        auto order = [&](KeyVec& low, KeyVec& high) {
            const KeyVec least = hn::Min(low, high);
            high = hn::Max(low, high);
            low = least;
        };
        (order(key[network[Step].low], key[network[Step].high]), ...);
    }
    (std::make_index_sequence<network.size()>());
    for (std::size_t i = 0; i < Count; ++i)
        if (i < rows) // behind them are another group's
            hn::StoreU(key[i], d, keys + i * kGroup);
}

/// Long lists, pixel by pixel.
void SortLongLists(const std::uint32_t* lengths, std::size_t lists, std::uint32_t* keys) {
    std::vector<std::uint32_t> list;
    for (std::size_t pixel = 0; pixel < lists; ++pixel) {
        list.resize(lengths[pixel]);
        for (std::size_t i = 0; i < list.size(); ++i)
            list[i] = keys[i * kGroup + pixel];
        std::sort(list.begin(), list.end());
        for (std::size_t i = 0; i < list.size(); ++i)
            keys[i * kGroup + pixel] = list[i];
    }
}

/// Turns the numbers of fragments of each pixel into the places where its list begins. Returns the number of rows.
std::uint64_t PlaceLists(FragmentLists& lists) {
    const KeyTag d;
    std::uint32_t* place = lists.list_end.data();
    std::uint64_t row = 0;
    for (std::size_t group = 0; group < lists.group_count(); ++group) {
        lists.group_row[group] = std::uint32_t(row);
        auto most = hn::Zero(d);
        for (std::size_t k = 0; k < kGroup; k += hn::Lanes(d)) {
            most = hn::Max(most, hn::LoadU(d, place + k));
            hn::StoreU(hn::Iota(d, std::uint32_t(row * kGroup + k)), d, place + k);
        }
        row += hn::GetLane(hn::MaxOfLanes(d, most));
        place += kGroup;
    }
    lists.group_row[lists.group_count()] = std::uint32_t(row);
    return row;
}

void SortGroups(FragmentLists& lists, std::uint32_t face_mask, std::uint32_t* near_count, std::uint32_t* far_count) {
    const KeyTag d;
    const std::size_t lanes = hn::Lanes(d);
    HWY_ALIGN std::uint32_t lengths[kGroup] = {};
    HWY_ALIGN std::uint32_t faces[kGroup] = {};
    auto add = [&](KeyVec keys, auto some, std::uint32_t* counts) {
        hn::Store(hn::Compress(hn::And(keys, hn::Set(d, face_mask)), some), d, faces);
        const std::size_t count = hn::CountTrue(d, some);
        for (std::size_t i = 0; i < count; ++i)
            ++counts[faces[i]];
    };
    for (std::size_t group = 0; group < lists.group_count(); ++group) {
        const std::uint32_t first = lists.group_row[group], rows = lists.group_row[group + 1] - first;
        if (rows == 0)
            continue;
        for (std::size_t k = 0; k < kGroup; k += lanes) {
            std::uint32_t* keys = lists.keys.data() + std::size_t(first) * kGroup + k;
            const KeyVec ends = hn::LoadU(d, lists.list_end.data() + group * kGroup + k);
            const KeyVec length = hn::Sub(hn::ShiftRight<4>(ends), hn::Set(d, first));
            if (rows > kMostSortedTogether) {
                hn::Store(length, d, lengths);
                SortLongLists(lengths, lanes, keys);
            } else if (rows > 12) {
                SortLists<16>(length, rows, keys);
            } else if (rows > 8) {
                SortLists<12>(length, rows, keys);
            } else if (rows > 6) {
                SortLists<8>(length, rows, keys);
            } else if (rows > 4) {
                SortLists<6>(length, rows, keys);
            } else if (rows > 2) {
                SortLists<4>(length, rows, keys);
            } else if (rows == 2) {
                SortLists<2>(length, rows, keys);
            }
            const KeyVec nearest = hn::LoadU(d, keys);
            KeyVec farthest = nearest;
            for (std::uint32_t i = 1; i < rows; ++i)
                farthest = hn::IfThenElse(hn::Lt(hn::Set(d, i), length), hn::LoadU(d, keys + i * kGroup), farthest);
            const auto some = hn::Gt(length, hn::Zero(d));
            add(nearest, some, near_count);
            add(farthest, some, far_count);
        }
    }
}

} // namespace kokage::bundles::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kokage::bundles {

HWY_EXPORT(PlaceLists);
HWY_EXPORT(SortGroups);

void sort_fragments(std::size_t pixels, std::span<const std::uint32_t> fragment_pixel,
                    std::span<const std::uint32_t> fragment_key, std::uint32_t face_mask, FragmentLists& lists,
                    std::vector<std::uint32_t>& near_count, std::vector<std::uint32_t>& far_count) {
    constexpr std::size_t group = FragmentLists::kGroup, room_to_read = 16 * group;
    static_assert(group == 16); // a shift by 4 divides by it
    lists.list_end.assign(pixels, 0);
    lists.group_row.resize(pixels / group + 1);
    std::uint32_t* place = lists.list_end.data();
    for (const std::uint32_t pixel : fragment_pixel)
        ++place[pixel];
    const std::uint64_t rows = HWY_DYNAMIC_DISPATCH(PlaceLists)(lists);
    if (rows * group > 0xffffffffull)
        throw InputError("bundles: a picture of " + std::to_string(fragment_key.size()) +
                         " fragments is too large: ask for path-traced");
    if (const std::size_t need = std::size_t(rows) * group + room_to_read; lists.keys.size() < need)
        lists.keys.resize(need);
    std::uint32_t* keys = lists.keys.data();
    for (std::size_t f = 0; f < fragment_key.size(); ++f) {
        std::uint32_t& next = place[fragment_pixel[f]];
        keys[next] = fragment_key[f];
        next += std::uint32_t(group);
    }
    HWY_DYNAMIC_DISPATCH(SortGroups)(lists, face_mask, near_count.data(), far_count.data());
}

} // namespace kokage::bundles
#endif
