#include "reflection/relief/tile_fourier.h"
#include "common/directions/batch_fft.h"
#include "common/services/parallel.h"

#include <algorithm>

namespace kokage {
namespace {

enum class Way { forward, backward };

/// All sequences of `length` elements that are `step` apart; sequence s begins at s * `between`.
void transform_sequences(TileWaves& waves, int length, std::size_t step, std::size_t count, std::size_t between,
                         Way way) {
    const BatchFft fft(length);
    parallel_blocks(count, BatchFft::kLanes, [&](std::size_t begin, std::size_t end) {
        std::vector<float> values(fft.floats(), 0.f), scratch(fft.floats());
        for (std::size_t s = begin; s < end; ++s)
            for (std::size_t k = 0; k < std::size_t(length); ++k) {
                const std::complex<float>& value = waves.values[s * between + k * step];
                values[k * BatchFft::kElement + s - begin] = value.real();
                values[k * BatchFft::kElement + BatchFft::kLanes + s - begin] = value.imag();
            }
        const std::span<float> result =
            way == Way::forward ? fft.forward(values, scratch) : fft.backward(values, scratch);
        for (std::size_t s = begin; s < end; ++s)
            for (std::size_t k = 0; k < std::size_t(length); ++k)
                waves.values[s * between + k * step] = {result[k * BatchFft::kElement + s - begin],
                                                        result[k * BatchFft::kElement + BatchFft::kLanes + s - begin]};
    });
}

void transform(TileWaves& waves, Way way) {
    const std::size_t width = std::size_t(waves.width), height = std::size_t(waves.height);
    transform_sequences(waves, waves.width, 1, height, width, way);
    transform_sequences(waves, waves.height, width, width, 1, way);
}

} // namespace

void transform_forward(TileWaves& waves) {
    transform(waves, Way::forward);
}

void transform_backward(TileWaves& waves) {
    transform(waves, Way::backward);
    const float share = 1 / float(waves.values.size());
    for (std::complex<float>& value : waves.values)
        value *= share;
}

double wave_number(int k, int size) {
    return 2 * k == size ? 0. : k < size - k ? k : k - size;
}

} // namespace kokage
