#pragma once
// Spherical-harmonic transforms of hundreds of bands in milliseconds: azimuth by Fourier transform, then for each order
// m a product with a table of Legendre functions that is prepared once (Driscoll and Healy 1994 and their successors;
// Schaeffer 2013, "Efficient spherical harmonic transforms aimed at pseudospectral numerical simulations", for the
// pairing of northern and southern rings). Single precision: errors a few 1e-6 of the largest value.
//
// Inside, the polar axis is world +Y, so that the rings are the rows of a lat-long image (lat_long.h); azimuth =
// atan2(z, x).
#include "common/directions/batch_fft.h"
#include "common/scene/image.h"
#include "common/services/large_vector.h"
#include "common/types.h"

#include <cstddef>
#include <span>
#include <vector>

namespace kokage {

/// Complex coefficients c_lm, m >= 0, of a real function of three channels:
///     f = Re sum over l < bands, m <= l of P_lm(y) c_lm e^(i m azimuth),   P_lm(y) = N_lm(y) (1 - y^2)^(m/2)
/// with N_lm of legendre.h: c_lm = a_lm - i b_lm of the real harmonics of orders m and -m (spherical_harmonics.h) taken
/// at (x, z, y).
class RingCoefficients {
  public:
    /// Numbers of one order and one parity of l - m stand together, padded to whole vectors.
    static constexpr int kPad = 16;
    static constexpr int kColumns = 6; ///< real r, g, b, imaginary r, g, b

    explicit RingCoefficients(int bands);
    int bands() const { return bands_; }
    /// How many l = m + parity, m + parity + 2, ... there are.
    int count(int m, int parity) const { return (bands_ - m - parity + 1) / 2; }
    int padded(int m, int parity) const { return (count(m, parity) + kPad - 1) / kPad * kPad; }
    /// kColumns runs of padded() floats.
    float* values(int m, int parity) { return values_.data() + first_[std::size_t(2 * m + parity)]; }
    const float* values(int m, int parity) const { return values_.data() + first_[std::size_t(2 * m + parity)]; }

  private:
    int bands_;
    std::vector<std::size_t> first_;
    std::vector<float> values_;
};

/// Tables of P_lm on rings that lie symmetrically about the equator.
class RingTables {
  public:
    enum class Order { along_bands, along_rings }; ///< what stands together: for analysis, for synthesis
    static constexpr int kBatch = int(BatchFft::kLanes);
    /// `polar`: polar angles of the northern rings, ascending, the equator (pi/2) last if `rings` is odd. `weights`:
    /// what each ring's functions are multiplied by; empty = 1. `spline`: the functions' coefficients of kRingSpline
    /// along the meridian instead of their values; the rings must then be (j + 1/2) pi / rings.
    /// `stored` begins with what values() of such tables were, which saves making them; empty = make them. Throws
    /// std::invalid_argument if it is too short.
    RingTables(int bands, int rings, std::span<const double> polar, std::span<const double> weights, bool spline,
               Order order, std::span<const float> stored = {});
    int bands() const { return bands_; }
    int rings() const { return rings_; }
    int pairs() const { return (rings_ + 1) / 2; } ///< of a northern and a southern ring; the equator is its own
    int batches() const { return (pairs() + kBatch - 1) / kBatch; } ///< of kBatch pairs, the last one padded
    /// Orders that don't vanish on a batch: fewer near the pole.
    int orders(int batch) const { return orders_[std::size_t(batch)]; }
    /// Order::along_bands: [pair of the batch][l of that parity, padded to 16], and the next batch's pairs follow;
    /// Order::along_rings: [l of that parity][pair of the batch]. m < orders(batch).
    const float* table(int batch, int m, int parity) const {
        return values_.data() + first_[std::size_t((batch * bands_ + m) * 2 + parity)];
    }
    std::span<const float> values() const { return values_; }

  private:
    int bands_, rings_;
    std::vector<int> orders_;
    std::vector<std::size_t> first_;
    LargeVector<float> values_;
};

/// From a lat-long image to coefficients: every pixel is a point of light at its centre with its exact solid angle, as
/// sums over pixels take it. (projection.h integrates over pixels instead.)
class RingAnalysis {
  public:
    RingAnalysis(int width, int height, int bands, std::span<const float> stored_tables = {});
    /// `image` has that size and at least 3 channels; values are multiplied by `scale` first. The same bits with any
    /// number of threads.
    void transform(const Image& image, float scale, RingCoefficients& coefficients) const;
    std::span<const float> tables() const { return tables_.values(); }

  private:
    int width_;
    RingTables tables_;
    BatchFft fft_;
};

/// Cubic MOMS, the interpolation of order 4 over four cells that has the least error: weights of the cells -1, 0, 1, 2
/// at 0 <= t < 1 are polynomials; here their coefficients of t^3, t^2, t and 1. Blu, Thevenaz and Unser 2001, "MOMS:
/// Maximal-order interpolation of minimal support", IEEE Transactions on Image Processing 10(7), eq 39. Like B-splines
/// (whose error is 4.6 times as large) they take coefficients, not values: of a wave of w radians a cell, its values
/// over (13 + 8 cos w) / 21; the error between cells is then 0.31 (w / 2 pi)^4 of it.
inline constexpr float kRingSpline[4][4] = {{-1 / 6.f, 1 / 2.f, -1 / 2.f, 1 / 6.f},
                                            {1 / 2.f, -1.f, 1 / 2.f, 0.f},
                                            {-11 / 21.f, 1 / 14.f, 3 / 7.f, 1 / 42.f},
                                            {4 / 21.f, 13 / 21.f, 4 / 21.f, 0.f}};

/// A function on rings (j + 1/2) pi / rings and columns at azimuth 2 pi i / columns, as coefficients of that spline in
/// both. Guards on all sides, so that a read needs no test.
struct RingGrid {
    static constexpr int kRowGuard = 2, kColumnGuard = 4;
    int rings = 0, columns = 0;
    LargeVector<glm::vec4> cells; ///< rgb and an unused fourth

    RingGrid(int rings_, int columns_);
    int stride() const { return columns + 2 * kColumnGuard; }
    /// ring -2 ... rings + 1, column -4 ... columns + 3
    const glm::vec4& at(int ring, int column) const {
        return cells[std::size_t(ring + kRowGuard) * std::size_t(stride()) + std::size_t(column + kColumnGuard)];
    }
    glm::vec4& at(int ring, int column) {
        return cells[std::size_t(ring + kRowGuard) * std::size_t(stride()) + std::size_t(column + kColumnGuard)];
    }
    /// The slow way to read it.
    glm::vec3 lookup(const glm::dvec3& direction) const;
};

/// From coefficients to grids of one size.
class RingSynthesis {
  public:
    /// columns even and >= 2 bands - 1.
    RingSynthesis(int bands, int rings, int columns, std::span<const float> stored_tables = {});
    int bands() const { return tables_.bands(); }
    int rings() const { return tables_.rings(); }
    int columns() const { return fft_.length(); }
    static constexpr std::size_t kMostGrids = 3;
    /// Up to kMostGrids grids at once, each f convolved with another zonal function: `zonals` are their zonal
    /// coefficients (zonal.h), at most bands() of them; fewer take less time. Everything is multiplied by `scale`. The
    /// same bits with any number of threads.
    void transform(const RingCoefficients& coefficients, std::span<const std::vector<double>> zonals, float scale,
                   std::span<RingGrid> grids) const;
    std::span<const float> tables() const { return tables_.values(); }

  private:
    void transform_batch(const RingCoefficients& coefficients, std::span<const float> zonals, std::size_t bands_used,
                         float scale, int batch, std::span<RingGrid> grids) const;

    RingTables tables_;
    BatchFft fft_;
    std::vector<float> order_factors_; ///< of the spline along azimuth, and 1/2 for the two sides of m > 0
};

} // namespace kokage
