#include "common/directions/projection.h"
#include "common/directions/legendre.h"
#include "common/directions/rotation.h"
#include "common/environment/lat_long.h"
#include "common/services/parallel.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <stdexcept>
#include <string>
#include <unsupported/Eigen/FFT>

namespace kokage {
namespace {

using Complex = std::complex<double>;

/// Sums of the prime factors: what an FFT of this length costs per element.
int fft_cost(int length) {
    int cost = 0;
    for (int factor = 2; length > 1; ++factor)
        for (; length % factor == 0; length /= factor)
            cost += factor;
    return cost;
}

/// Row spectra: integral over azimuth of radiance times e^(i m azimuth), per channel, for m < bands. Azimuth is
/// atan2(z, x).
/// [(row * bands + m) * 3 + channel]
std::vector<Complex> row_spectra(const Image& image, int bands) {
    const int width = image.width;
    const bool by_fft = width > 1 && fft_cost(width) < 2 * bands;
    // A pixel's integral of e^(i m azimuth) = its centre's value x width x sinc.
    std::vector<Complex> centre(static_cast<std::size_t>(bands)); // of pixel 0, integrated
    for (int m = 0; m < bands; ++m) {
        const double half = kPiDouble * m / width,
                     integral = 2 * kPiDouble / width * (m == 0 ? 1 : std::sin(half) / half);
        centre[std::size_t(m)] = integral * std::polar(1.0, m * (0.5 / width - 0.5) * 2 * kPiDouble);
    }
    std::vector<Complex> turn; // e^(2 pi i k / width)
    if (!by_fft)
        for (int k = 0; k < width; ++k)
            turn.push_back(std::polar(1.0, 2 * kPiDouble * k / width));
    std::vector<Complex> spectra(std::size_t(image.height) * std::size_t(bands) * 3);
    parallel_blocks(std::size_t(image.height), 16, [&](std::size_t begin, std::size_t end) {
        Eigen::FFT<double> fft;
        std::vector<Complex> row(static_cast<std::size_t>(width)), transformed;
        for (std::size_t y = begin; y < end; ++y)
            for (std::size_t c = 0; c < 3; ++c) {
                for (int x = 0; x < width; ++x)
                    row[std::size_t(x)] = double(image.at(x, int(y))[c]);
                if (by_fft)
                    fft.fwd(transformed, row); // sum of row[x] e^(-2 pi i m x / width)
                for (int m = 0; m < bands; ++m) {
                    Complex sum = 0;
                    if (by_fft) // conjugate, as the row is real; it repeats with m
                        sum = std::conj(transformed[std::size_t(m % width)]);
                    else
                        for (int x = 0; x < width; ++x)
                            sum += row[std::size_t(x)].real() * turn[std::size_t(std::int64_t(m) * x % width)];
                    spectra[(y * std::size_t(bands) + std::size_t(m)) * 3 + c] = centre[std::size_t(m)] * sum;
                }
            }
    });
    return spectra;
}

/// Coefficients in a right-handed frame whose polar axis is world +Y: z' = y, x' = z, y' = x, hence azimuth' = atan2(x,
/// z) = pi/2 - azimuth.
std::vector<double> polar_frame_coefficients(const Image& image, int bands, const std::vector<Complex>& spectra) {
    std::vector<double> coefficients(sh_count(bands) * 3);
    const double step = kPiDouble / image.height;
    // Gauss-Legendre in the polar angle within each row: analytic integrands, so a few nodes more than half the waves
    // in a row are exact.
    const std::vector<QuadratureNode> rule = gauss_legendre(6 + 2 * bands / image.height);
    parallel_blocks(std::size_t(bands), 1, [&](std::size_t first, std::size_t last) {
        for (int m = int(first); m < int(last); ++m) {
            std::vector<double> column(std::size_t(bands - m)), integral(std::size_t(bands - m));
            // e^(i m azimuth') = e^(i m pi/2) conj(e^(i m azimuth)); the quarter turns are exact.
            constexpr std::array<Complex, 4> quarter_turns = {Complex(1, 0), Complex(0, 1), Complex(-1, 0),
                                                              Complex(0, -1)};
            for (int y = 0; y < image.height; ++y) {
                std::fill(integral.begin(), integral.end(), 0.0);
                for (const QuadratureNode& node : rule) {
                    const double theta = (y + 0.5 + 0.5 * node.x) * step, sine = std::sin(theta);
                    polar_factors(bands, m, std::cos(theta), column);
                    const double weight = 0.5 * step * node.weight * sine * std::pow(sine, m);
                    for (std::size_t i = 0; i < integral.size(); ++i)
                        integral[i] += weight * column[i];
                }
                for (std::size_t c = 0; c < 3; ++c) {
                    const Complex spectrum =
                        quarter_turns[std::size_t(m % 4)] *
                        std::conj(spectra[(std::size_t(y) * std::size_t(bands) + std::size_t(m)) * 3 + c]);
                    for (int l = m; l < bands; ++l) {
                        coefficients[sh_index(l, m) * 3 + c] += integral[std::size_t(l - m)] * spectrum.real();
                        if (m > 0)
                            coefficients[sh_index(l, -m) * 3 + c] += integral[std::size_t(l - m)] * spectrum.imag();
                    }
                }
            }
        }
    });
    return coefficients;
}

void check_sizes(std::size_t directions, std::size_t values, std::size_t weights) {
    if (directions != values || directions != weights)
        throw std::invalid_argument("projection: " + std::to_string(directions) + " directions, " +
                                    std::to_string(values) + " values, " + std::to_string(weights) + " weights");
}

} // namespace

std::vector<glm::vec3> project_lat_long(const Image& image, int bands) {
    if (image.empty() || image.channels < 3 || bands < 1)
        throw std::invalid_argument("project_lat_long: an image of 3 channels and at least 1 band are needed");
    const std::vector<double> polar = polar_frame_coefficients(image, bands, row_spectra(image, bands));
    // Columns are the images of the axes: x' -> world z, y' -> world x, z' -> world y.
    const ShRotation to_world(glm::dmat3(glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0)), bands);
    std::vector<glm::vec3> result(sh_count(bands));
    std::vector<double> channel(sh_count(bands));
    for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < channel.size(); ++i)
            channel[i] = polar[i * 3 + c];
        to_world.apply(std::span<double>(channel));
        for (std::size_t i = 0; i < channel.size(); ++i)
            result[i][glm::length_t(c)] = float(channel[i]);
    }
    return result;
}

std::vector<glm::vec3> project_samples(std::span<const glm::vec3> directions, std::span<const glm::vec3> values,
                                       std::span<const double> weights, int bands) {
    check_sizes(directions.size(), values.size(), weights.size());
    std::vector<glm::dvec3> sum(sh_count(bands), glm::dvec3(0));
    std::vector<double> harmonics(sh_count(bands));
    for (std::size_t i = 0; i < directions.size(); ++i) {
        evaluate_sh(bands, glm::normalize(glm::dvec3(directions[i])), harmonics);
        const glm::dvec3 value = weights[i] * glm::dvec3(values[i]);
        for (std::size_t k = 0; k < sum.size(); ++k)
            sum[k] += harmonics[k] * value;
    }
    return {sum.begin(), sum.end()};
}

std::vector<glm::vec3> fit_samples(std::span<const glm::vec3> directions, std::span<const glm::vec3> values,
                                   std::span<const double> weights, int bands) {
    check_sizes(directions.size(), values.size(), weights.empty() ? directions.size() : weights.size());
    const auto rows = Eigen::Index(directions.size()), columns = Eigen::Index(sh_count(bands));
    if (rows < columns)
        throw std::invalid_argument("fit_samples: " + std::to_string(rows) + " directions can't fix " +
                                    std::to_string(columns) + " coefficients");
    Eigen::MatrixXd harmonics(rows, columns), right(rows, 3);
    std::vector<double> row(sh_count(bands));
    for (Eigen::Index i = 0; i < rows; ++i) {
        const auto k = std::size_t(i);
        const double root = weights.empty() ? 1 : std::sqrt(weights[k]);
        evaluate_sh(bands, glm::normalize(glm::dvec3(directions[k])), row);
        harmonics.row(i) = root * Eigen::Map<Eigen::RowVectorXd>(row.data(), columns);
        for (Eigen::Index c = 0; c < 3; ++c)
            right(i, c) = root * double(values[k][glm::length_t(c)]);
    }
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(harmonics);
    if (qr.rank() < columns)
        throw std::invalid_argument("fit_samples: the directions can't tell " + std::to_string(columns) +
                                    " coefficients apart");
    const Eigen::MatrixXd solution = qr.solve(right);
    std::vector<glm::vec3> result(sh_count(bands));
    for (Eigen::Index i = 0; i < columns; ++i)
        result[std::size_t(i)] = glm::vec3(solution(i, 0), solution(i, 1), solution(i, 2));
    return result;
}

} // namespace kokage
