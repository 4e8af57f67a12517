#pragma once
#include <cstddef>
#include <vector>

namespace kokage {

/// Pixels as floats, row by row from the TOP row, interleaved channels.
/// Colour images hold linear Rec.709 values; alpha, where there is one, is straight (never premultiplied).
struct Image {
    int width = 0, height = 0, channels = 0;
    std::vector<float> pixels;

    Image() = default;
    Image(int w, int h, int c) : width(w), height(h), channels(c), pixels(std::size_t(w) * h * c, 0.f) {}
    bool empty() const { return pixels.empty(); }
    float* at(int x, int y) { return pixels.data() + (std::size_t(y) * width + x) * channels; }
    const float* at(int x, int y) const { return pixels.data() + (std::size_t(y) * width + x) * channels; }
};

} // namespace kokage
