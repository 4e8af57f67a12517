#pragma once
// Tells bytes that were altered from those that were written, and one set of inputs from another; not against intent.
#include <cstddef>
#include <cstdint>
#include <span>

namespace kokage {

/// A 64-bit hash of any number of bytes, at the speed of memory; where bytes lie in several pieces, each one's hash is
/// the `start` of the next. The same on every machine that is little-endian.
std::uint64_t byte_hash(std::span<const std::byte> bytes, std::uint64_t start = 0);

} // namespace kokage
