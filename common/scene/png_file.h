#pragma once
// PNG files through libpng itself: OpenImageIO's reader lets it print lines of its own on the terminal. Private to
// common/scene.
#include "common/scene/image.h"

#include <cstddef>
#include <memory>
#include <span>
#include <stdexcept>

namespace kokage {

/// What is wrong with a PNG, as a part of a sentence: "it is cut off", "its pixels are damaged (...)".
struct PngError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A PNG in memory. Only what its pixels need is read (header, palette, transparent colour, pixels, end), and it must
/// agree with its checksums; what else it holds may be damaged.
class PngFile {
  public:
    /// Reads the header. `png` stays where it is as long as this lives. Throws PngError.
    explicit PngFile(std::span<const std::byte> png);
    ~PngFile();
    PngFile(const PngFile&) = delete;
    PngFile& operator=(const PngFile&) = delete;

    int width() const;
    int height() const;
    int channels() const; ///< 1 grey, 2 grey + alpha, 3 RGB, 4 RGBA: palettes expanded, alpha from tRNS counted
    int bits() const;     ///< 8 or 16; fewer are read as 8

    /// The pixels as stored, integers as 0..1. Memory is taken as the header says: check it first. Once only. Throws
    /// PngError.
    Image pixels();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace kokage
