#include "common/directions/spherical_harmonics.h"
#include "common/directions/legendre.h"

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

namespace kokage {
namespace {

constexpr int stack_bands = 32; ///< up to here no memory is allocated

/// One order m at a time: the polar factors of a column by their recurrence, times the real and imaginary parts of (x +
/// iy)^m. (x + iy)^m = sin^m(theta) e^(i m phi) underflows only where the harmonic itself is below 1e-190 or so, hence
/// no scaling is needed.
template <typename Real>
void evaluate(int bands, const glm::dvec3& direction, Real* values, std::span<double> column) {
    double real = 1, imaginary = 0;
    for (int m = 0; m < bands; ++m) {
        polar_factors(bands, m, direction.z, column);
        for (int l = m; l < bands; ++l) {
            const double factor = column[std::size_t(l - m)];
            values[sh_index(l, m)] = Real(factor * real);
            if (m > 0)
                values[sh_index(l, -m)] = Real(factor * imaginary);
        }
        const double next = real * direction.x - imaginary * direction.y;
        imaginary = real * direction.y + imaginary * direction.x;
        real = next;
    }
}

template <typename Real>
void evaluate(int bands, const glm::dvec3& direction, std::span<Real> values) {
    if (bands < 0 || values.size() < sh_count(bands))
        throw std::invalid_argument("evaluate_sh: " + std::to_string(values.size()) + " places for " +
                                    std::to_string(bands) + " bands");
    if (bands <= stack_bands) {
        std::array<double, stack_bands> column;
        evaluate(bands, direction, values.data(), std::span<double>(column));
    } else {
        std::vector<double> column(static_cast<std::size_t>(bands));
        evaluate(bands, direction, values.data(), std::span<double>(column));
    }
}

} // namespace

int sh_bands(std::size_t count) {
    const int bands = int(std::lround(std::sqrt(double(count))));
    if (sh_count(bands) != count)
        throw std::invalid_argument("spherical harmonics: " + std::to_string(count) +
                                    " coefficients are no whole number of bands");
    return bands;
}

void evaluate_sh(int bands, const glm::dvec3& direction, std::span<double> values) {
    evaluate<double>(bands, direction, values);
}

// Worked in double: a float direction is off unit length by 1e-7, which the recurrence would amplify with the number of
// bands.
void evaluate_sh(int bands, const glm::vec3& direction, std::span<float> values) {
    evaluate<float>(bands, glm::normalize(glm::dvec3(direction)), values);
}

glm::vec3 sh_radiance(std::span<const glm::vec3> coefficients, const glm::vec3& direction) {
    const int bands = sh_bands(coefficients.size());
    std::array<float, sh_count(stack_bands)> on_stack;
    std::vector<float> on_heap;
    if (bands > stack_bands)
        on_heap.resize(coefficients.size());
    const std::span<float> values = bands > stack_bands ? std::span<float>(on_heap) : std::span<float>(on_stack);
    evaluate_sh(bands, direction, values);
    glm::vec3 sum(0.f);
    for (std::size_t i = 0; i < coefficients.size(); ++i)
        sum += coefficients[i] * values[i];
    return sum;
}

} // namespace kokage
