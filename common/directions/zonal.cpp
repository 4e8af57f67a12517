#include "common/directions/zonal.h"
#include "common/directions/legendre.h"

namespace kokage {

void add_zonal(std::span<glm::vec3> coefficients, const glm::vec3& direction, const glm::vec3& amount,
               std::span<const double> zonal) {
    const int bands = sh_bands(coefficients.size());
    std::vector<float> values(coefficients.size());
    evaluate_sh(bands, direction, values);
    for (int l = 0; l < std::min(bands, int(zonal.size())); ++l)
        for (int m = -l; m <= l; ++m)
            coefficients[sh_index(l, m)] += amount * float(zonal[std::size_t(l)] * double(values[sh_index(l, m)]));
}

double evaluate_zonal(std::span<const double> zonal, double t) {
    std::vector<double> legendre(zonal.size());
    legendre_polynomials(t, legendre);
    double sum = 0;
    for (std::size_t l = 0; l < zonal.size(); ++l)
        sum += (2.0 * double(l) + 1) / (4 * kPiDouble) * zonal[l] * legendre[l];
    return sum;
}

std::vector<double> zonal_coefficients(int bands, const std::function<double(double)>& h,
                                       std::span<const double> breaks, int nodes) {
    std::vector<double> result(static_cast<std::size_t>(bands)), legendre(static_cast<std::size_t>(bands));
    const std::vector<QuadratureNode> rule = gauss_legendre(nodes);
    for (std::size_t piece = 1; piece < breaks.size(); ++piece) {
        const double half = 0.5 * (breaks[piece] - breaks[piece - 1]),
                     middle = 0.5 * (breaks[piece] + breaks[piece - 1]);
        for (const QuadratureNode& node : rule) {
            const double t = middle + half * node.x, weight = 2 * kPiDouble * half * node.weight * h(t);
            legendre_polynomials(t, legendre);
            for (std::size_t l = 0; l < result.size(); ++l)
                result[l] += weight * legendre[l];
        }
    }
    return result;
}

} // namespace kokage
