#pragma once
// Damaged copies of a file's bytes: numbers replaced, bytes changed, cut off, spliced.
#include "common/services/random.h"

#include <iterator>
#include <string>

namespace kokage {

/// One number of 32 or 64 bits in the first `range` bytes becomes one that readers stumble over.
inline void replace_number(std::string& bytes, std::size_t range, Random& random) {
    const std::size_t width = random.below(2) == 0 ? 4 : 8, at = random.below(std::uint32_t(range / 4)) * 4;
    const std::uint64_t values[] = {0,     1,          2,          0x7fffffff, 0xffffffff, 0x80000000, bytes.size(),
                                    ~0ull, ~0ull - 15, 1ull << 32, 0xfffffff8, 16384,      6,          random.next()};
    const std::uint64_t value = values[random.below(std::uint32_t(std::size(values)))];
    for (std::size_t i = 0; i < width && at + i < bytes.size(); ++i)
        bytes[at + i] = char(value >> (8 * i) & 255u);
}

/// Half of the mutants differ within the first `head` bytes alone.
inline std::string mutant_of(const std::string& good, std::size_t head, Random& random) {
    std::string bytes = good;
    switch (random.below(6)) {
    case 0:
        bytes.resize(random.below(std::uint32_t(bytes.size())));
        break;
    case 1: // splice: a piece of the file over another place, with another length
        bytes.replace(random.below(std::uint32_t(bytes.size())), random.below(40),
                      good.substr(random.below(std::uint32_t(good.size())), random.below(40)));
        break;
    case 2:
        bytes[random.below(std::uint32_t(bytes.size()))] ^= char(1u << random.below(8));
        break;
    default:
        for (std::uint32_t i = 1 + random.below(3); i > 0; --i) {
            if (random.below(2) == 0)
                replace_number(bytes, head, random);
            else
                bytes[random.below(std::uint32_t(head))] = char(random.next() & 255u);
        }
    }
    return bytes;
}

} // namespace kokage
