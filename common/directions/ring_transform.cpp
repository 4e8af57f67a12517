#include "common/directions/ring_transform.h"
#include "common/directions/ring_product.h"
#include "common/environment/lat_long.h"
#include "common/services/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <stdexcept>

namespace kokage {
namespace {

constexpr std::size_t kLanes = BatchFft::kLanes, kElement = BatchFft::kElement;
constexpr std::size_t kColumns = RingCoefficients::kColumns;
constexpr std::size_t kOrdersABlock = 8;

std::vector<double> row_polar_angles(int rows) {
    std::vector<double> polar;
    for (int j = 0; j < (rows + 1) / 2; ++j)
        polar.push_back((j + 0.5) / rows * kPiDouble);
    return polar;
}

std::vector<double> row_solid_angles(int width, int rows) {
    std::vector<double> weights;
    for (int j = 0; j < (rows + 1) / 2; ++j)
        weights.push_back(pixel_solid_angle(j, width, rows));
    return weights;
}

/// Pixels of 16 pairs of rows as sequences: northern row + i southern row. The equator's row has no southern one.
void gather_rows(const Image& image, float scale, std::size_t first_pair, int channel, float* sequence) {
    const int pairs = (image.height + 1) / 2;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const int north = int(first_pair + lane), south = image.height - 1 - north;
        for (int x = 0; x < image.width; ++x) {
            float* element = sequence + std::size_t(x) * kElement + lane;
            element[0] = north < pairs ? scale * image.at(x, north)[channel] : 0.f;
            element[kLanes] = north < pairs && south > north ? scale * image.at(x, south)[channel] : 0.f;
        }
    }
}

} // namespace

RingCoefficients::RingCoefficients(int bands) : bands_(bands) {
    if (bands < 1)
        throw std::invalid_argument("RingCoefficients: at least 1 band is needed");
    std::size_t size = 0;
    for (int m = 0; m < bands; ++m)
        for (int parity = 0; parity < 2; ++parity) {
            first_.push_back(size);
            size += std::size_t(kColumns) * std::size_t(padded(m, parity));
        }
    values_.resize(size);
}

RingAnalysis::RingAnalysis(int width, int height, int bands, std::span<const float> stored_tables)
    : width_(width), tables_(bands, height, row_polar_angles(height), row_solid_angles(width, height), false,
                             RingTables::Order::along_bands, stored_tables),
      fft_(width) {}

void RingAnalysis::transform(const Image& image, float scale, RingCoefficients& coefficients) const {
    const int bands = tables_.bands();
    if (image.width != width_ || image.height != tables_.rings() || image.channels < 3 || coefficients.bands() != bands)
        throw std::invalid_argument("RingAnalysis: the image's size or the bands are not those that it was made for");
    const auto pairs = std::size_t(tables_.pairs()), orders = std::size_t(bands), width = std::size_t(width_);
    // Spectra of north + south (for even l - m) and north - south (for odd): [m][parity][pair][kColumns].
    UninitializedVector<float> spectra(orders * 2 * pairs * kColumns);
    parallel_blocks(pairs, kLanes, [&](std::size_t begin, std::size_t end) {
        UninitializedVector<float> sequence(fft_.floats()), scratch(fft_.floats());
        for (std::size_t channel = 0; channel < 3; ++channel) {
            gather_rows(image, scale, begin, int(channel), sequence.data());
            const std::span<float> transformed = fft_.forward(sequence, scratch);
            for (std::size_t m = 0; m < orders; ++m) {
                // Beyond the image's own waves the spectrum repeats: points of light have no highest wave.
                const float* positive = transformed.data() + m % width * kElement;
                const float* negative = transformed.data() + (width - m % width) % width * kElement;
                for (std::size_t pair = begin; pair < end; ++pair) {
                    const std::size_t lane = pair - begin;
                    const float re = positive[lane], im = positive[kLanes + lane], other_re = negative[lane],
                                other_im = negative[kLanes + lane];
                    const float north_re = 0.5f * (re + other_re), north_im = 0.5f * (im - other_im);
                    const float south_re = 0.5f * (im + other_im), south_im = 0.5f * (other_re - re);
                    float* even = spectra.data() + ((m * 2) * pairs + pair) * kColumns + channel;
                    float* odd = even + pairs * kColumns;
                    even[0] = north_re + south_re;
                    even[3] = north_im + south_im;
                    odd[0] = north_re - south_re;
                    odd[3] = north_im - south_im;
                }
            }
        }
    });
    parallel_blocks(orders, kOrdersABlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t m = begin; m < end; ++m) {
            // The first pixel's centre is at azimuth (1/2 / width - 1/2) 2 pi.
            const std::complex<double> turn = std::polar(1.0, -double(m) * (0.5 / width_ - 0.5) * 2 * kPiDouble);
            const float re = float(turn.real()), im = float(turn.imag());
            for (int parity = 0; parity < 2; ++parity) {
                const auto padded = std::size_t(coefficients.padded(int(m), parity));
                int batch = 0;
                while (tables_.orders(batch) <= int(m) && batch + 1 < tables_.batches())
                    ++batch;
                const auto first = std::size_t(batch) * kLanes;
                float* values = coefficients.values(int(m), parity);
                ring_analysis_product(tables_.table(batch, int(m), parity), pairs - first, padded,
                                      spectra.data() + ((m * 2 + std::size_t(parity)) * pairs + first) * kColumns,
                                      values);
                for (std::size_t i = 0; i < 3 * padded; ++i) {
                    const float a = values[i], b = values[3 * padded + i];
                    values[i] = a * re - b * im;
                    values[3 * padded + i] = a * im + b * re;
                }
            }
        }
    });
}

RingGrid::RingGrid(int rings_, int columns_)
    : rings(rings_), columns(columns_),
      cells(std::size_t(rings_ + 2 * kRowGuard) * std::size_t(columns_ + 2 * kColumnGuard)) {}

namespace {

std::array<double, 4> spline_weights(double t) {
    std::array<double, 4> weights;
    for (std::size_t i = 0; i < 4; ++i)
        weights[i] = ((double(kRingSpline[0][i]) * t + double(kRingSpline[1][i])) * t + double(kRingSpline[2][i])) * t +
                     double(kRingSpline[3][i]);
    return weights;
}

} // namespace

glm::vec3 RingGrid::lookup(const glm::dvec3& direction) const {
    double turn = std::atan2(direction.z, direction.x) / (2 * kPiDouble);
    turn -= std::floor(turn);
    const double polar = std::atan2(std::hypot(direction.x, direction.z), direction.y);
    const double x = std::min(turn * columns, double(columns)), y = polar / kPiDouble * rings - 0.5;
    const int column = int(std::floor(x)), ring = std::min(int(std::floor(y)), rings - 1);
    const auto across = spline_weights(x - column), down = spline_weights(y - ring);
    glm::dvec3 sum(0);
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i)
            sum +=
                across[std::size_t(i)] * down[std::size_t(j)] * glm::dvec3(glm::vec3(at(ring - 1 + j, column - 1 + i)));
    return glm::vec3(sum);
}

RingSynthesis::RingSynthesis(int bands, int rings, int columns, std::span<const float> stored_tables)
    : tables_(bands, rings, row_polar_angles(rings), {}, true, RingTables::Order::along_rings, stored_tables),
      fft_(columns) {
    if (columns % 2 != 0 || columns < 2 * bands - 1)
        throw std::invalid_argument("RingSynthesis: columns must be even and at least twice the bands");
    for (int m = 0; m < bands; ++m)
        order_factors_.push_back(float((m == 0 ? 1 : 0.5) * 21 / (13 + 8 * std::cos(2 * kPiDouble * m / columns))));
}

namespace {

/// Even and odd parts on 16 pairs of rings -> elements m and columns - m of the sequences north + i south.
void store_order(const float* even, const float* odd, float factor, float* positive, float* negative) {
    const float *even_im = even + 3 * kLanes, *odd_im = odd + 3 * kLanes;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const float north_re = factor * (even[lane] + odd[lane]), south_re = factor * (even[lane] - odd[lane]);
        const float north_im = factor * (even_im[lane] + odd_im[lane]),
                    south_im = factor * (even_im[lane] - odd_im[lane]);
        positive[lane] = north_re - south_im;
        positive[kLanes + lane] = north_im + south_re;
        negative[lane] = north_re + south_im;
        negative[kLanes + lane] = south_re - north_im;
    }
}

/// The finished sequences of 16 pairs of rings into the grid's rows.
void store_rings(const std::array<std::span<float>, 3>& channels, std::size_t first_pair, RingGrid& grid) {
    const std::size_t pairs = std::size_t(grid.rings + 1) / 2, here = std::min(kLanes, pairs - first_pair);
    std::array<float*, kLanes> north{}, south{};
    for (std::size_t lane = 0; lane < here; ++lane) {
        north[lane] = &grid.at(int(first_pair + lane), 0).x;
        south[lane] = &grid.at(grid.rings - 1 - int(first_pair + lane), 0).x;
    }
    auto store = [&](std::size_t part, std::size_t rings, float* const* rows) {
        interleave_rings(channels[0].data() + part, channels[1].data() + part, channels[2].data() + part,
                         std::size_t(grid.columns), rings, rows);
    };
    // The equator is the last of an odd number of rings' pairs and has no southern ring: its northern one comes last.
    store(kLanes, here, south.data());
    store(0, here, north.data());
}

void fill_guards(RingGrid& grid) {
    for (int guard = 0; guard < RingGrid::kRowGuard; ++guard)
        for (int x = 0; x < grid.columns; ++x) {
            // Over the pole, on the other side.
            const int opposite = (x + grid.columns / 2) % grid.columns;
            const int north = std::min(guard, grid.rings - 1), south = std::max(grid.rings - 1 - guard, 0);
            grid.at(-1 - guard, x) = grid.at(north, opposite);
            grid.at(grid.rings + guard, x) = grid.at(south, opposite);
        }
    for (int ring = -RingGrid::kRowGuard; ring < grid.rings + RingGrid::kRowGuard; ++ring)
        for (int guard = 0; guard < RingGrid::kColumnGuard; ++guard) {
            grid.at(ring, grid.columns + guard) = grid.at(ring, guard);
            grid.at(ring, -1 - guard) = grid.at(ring, grid.columns - 1 - guard);
        }
}

} // namespace

void RingSynthesis::transform(const RingCoefficients& coefficients, std::span<const std::vector<double>> zonals,
                              float scale, std::span<RingGrid> grids) const {
    if (zonals.size() != grids.size() || grids.size() > kMostGrids || coefficients.bands() < bands())
        throw std::invalid_argument("RingSynthesis: too many grids or too few bands");
    // [grid][parity of l][l / 2]: the l of one order and parity stand together.
    const std::size_t half = std::size_t(bands() + 1) / 2;
    std::vector<float> by_parity(grids.size() * 2 * half);
    for (std::size_t g = 0; g < grids.size(); ++g) {
        if (zonals[g].size() > std::size_t(bands()) || grids[g].rings != rings() || grids[g].columns != columns())
            throw std::invalid_argument("RingSynthesis: more bands or another grid than it was made for");
        for (std::size_t l = 0; l < zonals[g].size(); ++l)
            by_parity[(g * 2 + l % 2) * half + l / 2] = float(zonals[g][l]);
    }
    std::size_t bands_used = 1;
    for (const std::vector<double>& zonal : zonals)
        bands_used = std::max(bands_used, zonal.size());
    parallel_blocks(std::size_t(tables_.batches()), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t batch = begin; batch < end; ++batch)
            transform_batch(coefficients, by_parity, bands_used, scale, int(batch), grids);
    });
    for (RingGrid& grid : grids)
        fill_guards(grid);
}

void RingSynthesis::transform_batch(const RingCoefficients& coefficients, std::span<const float> zonals,
                                    std::size_t bands_used, float scale, int batch, std::span<RingGrid> grids) const {
    const auto columns = std::size_t(fft_.length()), orders = std::min(std::size_t(tables_.orders(batch)), bands_used);
    const std::size_t half = std::size_t(bands() + 1) / 2;
    // [grid][channel][column], ready for the transform along azimuth
    UninitializedVector<float> spectra((grids.size() * 3 + 3) * columns * kElement);
    auto element = [&](std::size_t grid, std::size_t channel, std::size_t column) {
        return spectra.data() + ((grid * 3 + channel) * columns + column) * kElement;
    };
    alignas(64) float parts[2][kMostGrids * kColumns * kLanes];
    for (std::size_t m = 0; m < orders; ++m) {
        for (std::size_t parity = 0; parity < 2; ++parity) {
            const std::size_t first = m + parity;
            std::array<const float*, kMostGrids> zonal{};
            for (std::size_t g = 0; g < grids.size(); ++g)
                zonal[g] = zonals.data() + (g * 2 + first % 2) * half + first / 2;
            const std::size_t rows = first < bands_used ? (bands_used - first + 1) / 2 : 0;
            ring_synthesis_product(
                tables_.table(batch, int(m), int(parity)), rows, coefficients.values(int(m), int(parity)),
                std::size_t(coefficients.padded(int(m), int(parity))), zonal.data(), grids.size(), parts[parity]);
        }
        alignas(64) float unused[kElement];
        for (std::size_t g = 0; g < grids.size(); ++g)
            for (std::size_t channel = 0; channel < 3; ++channel) {
                const std::size_t part = (g * kColumns + channel) * kLanes;
                store_order(parts[0] + part, parts[1] + part, scale * order_factors_[m], element(g, channel, m),
                            m > 0 ? element(g, channel, columns - m) : unused);
            }
    }
    const std::span<float> scratch = std::span<float>(spectra).subspan(grids.size() * 3 * fft_.floats());
    for (std::size_t g = 0; g < grids.size(); ++g) {
        std::array<std::span<float>, 3> transformed;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            std::fill(element(g, channel, orders), element(g, channel, columns - orders + 1), 0.f);
            transformed[channel] = fft_.backward(std::span<float>(element(g, channel, 0), fft_.floats()),
                                                 scratch.subspan(channel * fft_.floats(), fft_.floats()));
        }
        store_rings(transformed, std::size_t(batch) * kLanes, grids[g]);
    }
}

} // namespace kokage
