// Owen scrambling by hashing: Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020, listings 1-4, with the
// better mixing of Vegdahl, "Building a Better LK Hash" (2021). All words are kept bit-reversed until the end, which
// spares two of Burley's three reversals: the scrambling wants its input reversed.
#include "common/trace/path_numbers.h"

#include <array>

namespace kokage {
namespace {

std::uint32_t reverse_bits(std::uint32_t x) {
    x = __builtin_bswap32(x);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    return ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
}

/// Nested uniform scrambling of a bit-reversed word: every bit is flipped by a hash of the bits below it (Vegdahl
/// 2021).
std::uint32_t scramble_reversed(std::uint32_t x, std::uint32_t seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

/// Second dimension of Sobol's sequence, bit-reversed, by bytes of the index. Its generator matrix is Pascal's triangle
/// mod 2: column k of the reversed matrix has bit j set where C(k, j) is odd, that is where j's bits are among k's
/// (Lucas).
struct PascalTable {
    std::array<std::array<std::uint32_t, 256>, 4> words{};
    constexpr PascalTable() {
        for (std::uint32_t byte = 0; byte < 4; ++byte)
            for (std::uint32_t value = 0; value < 256; ++value)
                for (std::uint32_t bit = 0; bit < 8; ++bit)
                    if (value >> bit & 1)
                        for (std::uint32_t j = 0, k = 8 * byte + bit; j <= k; ++j)
                            words[byte][value] ^= (j & ~k) == 0 ? 1u << j : 0u;
    }
};
constexpr PascalTable pascal;

std::uint32_t second_sobol_reversed(std::uint32_t index) {
    return pascal.words[0][index & 255] ^ pascal.words[1][index >> 8 & 255] ^ pascal.words[2][index >> 16 & 255] ^
           pascal.words[3][index >> 24];
}

float unit_float(std::uint32_t reversed) {
    return float(reverse_bits(reversed) >> 8) * 0x1p-24f;
}

/// Shuffles indices so that every aligned block of 2^k indices stays a block (Burley's listing 4).
std::uint32_t shuffled(std::uint32_t index, std::uint32_t seed) {
    return reverse_bits(scramble_reversed(reverse_bits(index), seed));
}

} // namespace

float PathNumbers::single() {
    if (dimension_ >= kSequences)
        return random_.uniform();
    const std::uint64_t key = hash64(seed_ + std::uint64_t(dimension_++));
    // The first dimension of Sobol's sequence is the reversed index, so the index is that number bit-reversed.
    return unit_float(scramble_reversed(shuffled(index_, std::uint32_t(key)), std::uint32_t(key >> 32)));
}

glm::vec2 PathNumbers::pair() {
    if (dimension_ >= kSequences) {
        const float first = random_.uniform();
        return {first, random_.uniform()};
    }
    return SobolPairs::of_hash(seed_, dimension_++).at(index_);
}

SobolPairs::SobolPairs(std::uint64_t seed, int dimension) : SobolPairs(of_hash(hash64(seed), dimension)) {}

SobolPairs SobolPairs::of_hash(std::uint64_t hashed_seed, int dimension) {
    const std::uint64_t key = hash64(hashed_seed + std::uint64_t(dimension));
    return SobolPairs(Keys{key, hash64(key)});
}

glm::vec2 SobolPairs::at(std::uint32_t index) const {
    const std::uint32_t place = shuffled(index, std::uint32_t(keys_.first));
    return {unit_float(scramble_reversed(place, std::uint32_t(keys_.first >> 32))),
            unit_float(scramble_reversed(second_sobol_reversed(place), std::uint32_t(keys_.second)))};
}

} // namespace kokage
