#pragma once
// The two-dimensional discrete Fourier transform of a tile. Private to relief.
#include <complex>
#include <vector>

namespace kokage {

/// Values, or their spectrum: row by row; frequency k of `size` stands for k waves a tile, or k - size.
struct TileWaves {
    int width = 0, height = 0;
    std::vector<std::complex<float>> values;

    TileWaves(int w, int h) : width(w), height(h), values(std::size_t(w) * std::size_t(h)) {}
    std::complex<float>& at(int x, int y) { return values[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
};

/// In place; any size, fast where width's and height's prime factors are small. Error: a few 1e-7 of the root of the
/// sum of squares. The same bits for any number of threads.
void transform_forward(TileWaves& waves);
/// The inverse: divided by width x height.
void transform_backward(TileWaves& waves);

/// Waves a tile that frequency k of `size` stands for: within -size/2 ... size/2, and 0 for the highest of an even
/// size, which has no slope at the texels.
double wave_number(int k, int size);

} // namespace kokage
