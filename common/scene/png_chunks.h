#pragma once
// Chunks of PNG files. Private to common/scene.
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace kokage {

/// A PNG's chunks that its pixels need (header, palette, transparent colour, pixels, end), checked against their
/// checksums (PNG specification, third edition, section 5). libpng prints lines of its own on the terminal about
/// damaged pixels and about colour profiles that it doesn't like; what comes out of here gives it little cause. Empty,
/// and `why` says so ("its pixels are damaged"), if a chunk is missing, cut off or differs from its checksum.
std::vector<std::byte> essential_png_chunks(std::span<const std::byte> png, std::string& why);

} // namespace kokage
