#include "reflection/relief/tiling.h"
#include "reflection/relief/tile_fourier.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace kokage {
namespace {

/// Sum of squared steps between texels and those `dx`, `dy` further, of `columns` x `rows` texels from the first.
double squared_steps(const Image& heights, int dx, int dy, int columns, int rows) {
    double sum = 0;
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x)
            sum += std::pow(double(*heights.at(x + dx, y + dy)) - double(*heights.at(x, y)), 2);
    return sum;
}

double step_ratio(double over_edge, double within, int count) {
    if (count < 2 || over_edge == 0)
        return 1;
    return within == 0 ? std::numeric_limits<double>::infinity() : std::sqrt(over_edge / (within / (count - 1)));
}

} // namespace

glm::dvec2 seam_steps(const Image& heights) {
    const int w = heights.width, h = heights.height;
    return {step_ratio(squared_steps(heights, w - 1, 0, 1, h), squared_steps(heights, 1, 0, w - 1, h), w),
            step_ratio(squared_steps(heights, 0, h - 1, w, 1), squared_steps(heights, 0, 1, w, h - 1), h)};
}

Image periodic_part(const Image& heights) {
    const int w = heights.width, h = heights.height;
    // The steps over the edges, as the Laplacian of the smooth part (eq 10).
    TileWaves smooth(w, h);
    for (int y = 0; y < h; ++y) {
        const float step = *heights.at(w - 1, y) - *heights.at(0, y);
        smooth.at(0, y) += step;
        smooth.at(w - 1, y) -= step;
    }
    for (int x = 0; x < w; ++x) {
        const float step = *heights.at(x, h - 1) - *heights.at(x, 0);
        smooth.at(x, 0) += step;
        smooth.at(x, h - 1) -= step;
    }
    transform_forward(smooth);
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) { // the discrete Laplacian's inverse (eq 11)
            const double scale =
                2 * std::cos(2 * std::numbers::pi * x / w) + 2 * std::cos(2 * std::numbers::pi * y / h) - 4;
            smooth.at(x, y) *= x == 0 && y == 0 ? 0.f : float(1 / scale);
        }
    transform_backward(smooth);
    Image periodic = heights;
    for (std::size_t i = 0; i < periodic.pixels.size(); ++i)
        periodic.pixels[i] -= smooth.values[i].real();
    return periodic;
}

} // namespace kokage
