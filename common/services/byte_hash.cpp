#include "common/services/byte_hash.h"
#include "common/services/random.h"

#include <array>
#include <bit>
#include <cstring>

namespace kokage {
namespace {

static_assert(std::endian::native == std::endian::little, "hashes in files are of little-endian words");

std::uint64_t mixed(std::uint64_t sum, std::uint64_t word) {
    return (std::rotl(sum, 29) ^ word) * 0x9e3779b97f4a7c15ull;
}

} // namespace

/// Four sums side by side: one alone would wait for its own multiplications.
std::uint64_t byte_hash(std::span<const std::byte> bytes, std::uint64_t start) {
    std::array<std::uint64_t, 4> sums = {1, 2, 3, 4};
    std::size_t at = 0;
    for (; at + 32 <= bytes.size(); at += 32)
        for (std::size_t k = 0; k < 4; ++k) {
            std::uint64_t word;
            std::memcpy(&word, bytes.data() + at + 8 * k, sizeof word);
            sums[k] = mixed(sums[k], word);
        }
    for (std::size_t k = 0; at < bytes.size(); ++at, ++k)
        sums[k % 4] = mixed(sums[k % 4], std::uint64_t(bytes[at]));
    std::uint64_t hash = hash64(start ^ bytes.size());
    for (const std::uint64_t sum : sums)
        hash = hash64(hash ^ sum);
    return hash;
}

} // namespace kokage
