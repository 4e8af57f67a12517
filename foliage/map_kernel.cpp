#include "foliage/map_kernel.h"
#include "common/directions/legendre.h"
#include "common/types.h"

namespace kokage {

std::vector<double> squared_dirichlet_factors(int bands) {
    const int dirichlet_bands = (bands + 1) / 2;
    std::vector<double> factors(std::size_t(bands), 0.0), legendre(std::size_t(bands), 0.0);
    for (const QuadratureNode& node : gauss_legendre(2 * bands)) { // exact for the kernel times P_l
        legendre_polynomials(node.x, legendre);
        double dirichlet = 0;
        for (int l = 0; l < dirichlet_bands; ++l)
            dirichlet += (2 * l + 1) * legendre[std::size_t(l)];
        for (std::size_t l = 0; l < factors.size(); ++l)
            factors[l] += node.weight * dirichlet * dirichlet * legendre[l];
    }
    for (std::size_t l = factors.size(); l-- > 0;)
        factors[l] /= factors[0]; // unit mass
    return factors;
}

std::vector<double> clamped_cosine_factors(int bands) {
    std::vector<double> factors(std::size_t(bands), 0.0);
    double central = 1; // l! / (2^l (l/2)!^2)
    for (int l = 0; l < bands; ++l) {
        if (l == 1)
            factors[1] = 2 * kPiDouble / 3;
        if (l % 2 != 0)
            continue;
        if (l > 0)
            central *= double(l - 1) / l;
        const double sign = l % 4 == 0 ? -1 : 1; // (-1)^(l/2 - 1); at l = 0 the denominator's sign makes it pi
        factors[std::size_t(l)] = 2 * kPiDouble * sign * central / ((l + 2.0) * (l - 1.0));
    }
    return factors;
}

} // namespace kokage
