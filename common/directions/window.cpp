#include "common/directions/window.h"
#include "common/directions/zonal.h"
#include "common/services/error.h"

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <string>

namespace kokage {
namespace {

/// Orthonormal polynomials of the weight 1 (Legendre) or 1 + t (Jacobi with parameters 0, 1) by the recurrence
/// b_{k+1} p_{k+1} = (t - a_k) p_k - b_k p_{k-1}; a_k, b_k are the entries of their Jacobi matrix.
struct Recurrence {
    bool weighted;
    double a(int k) const { return weighted ? 1 / ((2.0 * k + 1) * (2.0 * k + 3)) : 0; }
    double b(int k) const {
        return weighted ? std::sqrt(k * (k + 1.0)) / (2.0 * k + 1) : k / std::sqrt(4.0 * k * k - 1);
    }
};

/// The sharpest kernel of degree 2 count - 2 (plus 1 if weighted): q(t)^2, or (1 + t) q(t)^2, where q is the polynomial
/// of degree count - 1 that is 0 in all roots of p_count but the largest one, x. By Christoffel and Darboux q = sum of
/// p_k(x) p_k, and the p_k(x) are the eigenvector of the Jacobi matrix to its largest eigenvalue x.
std::function<double(double)> sharpest_kernel(int count, bool weighted) {
    const Recurrence recurrence{weighted};
    Eigen::VectorXd diagonal(count), below(std::max(count - 1, 0));
    for (int k = 0; k < count; ++k)
        diagonal[k] = recurrence.a(k);
    for (int k = 1; k < count; ++k)
        below[k - 1] = recurrence.b(k);
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
    solver.computeFromTridiagonal(diagonal, below);
    const Eigen::VectorXd at_root = solver.eigenvectors().col(count - 1);
    return [=](double t) {
        double previous = 0, current = 1, sum = at_root[0];
        for (int k = 0; k + 1 < count; ++k) {
            const double next =
                ((t - recurrence.a(k)) * current - (k > 0 ? recurrence.b(k) * previous : 0)) / recurrence.b(k + 1);
            previous = current;
            current = next;
            sum += at_root[k + 1] * current;
        }
        return (weighted ? 1 + t : 1) * sum * sum;
    };
}

std::vector<double> factors_of_kernel(int bands, const std::function<double(double)>& kernel) {
    constexpr std::array<double, 2> whole = {-1, 1};
    std::vector<double> k = zonal_coefficients(bands, kernel, whole, bands + 1);
    const double mass = k[0];
    for (double& value : k)
        value /= mass;
    return k;
}

} // namespace

std::vector<double> window_factors(Window window, int bands) {
    if (bands < 1)
        return {};
    std::vector<double> factors(std::size_t(bands), 1.0);
    switch (window) {
    case Window::none:
        break;
    case Window::hann:
        for (int l = 0; l < bands; ++l)
            factors[std::size_t(l)] = 0.5 * (1 + std::cos(kPiDouble * l / bands));
        break;
    case Window::lanczos:
        for (int l = 1; l < bands; ++l)
            factors[std::size_t(l)] = std::sin(kPiDouble * l / bands) / (kPiDouble * l / bands);
        break;
    case Window::non_negative: {
        const int degree = bands - 1;
        return factors_of_kernel(bands, sharpest_kernel(degree / 2 + 1, degree % 2 == 1));
    }
    case Window::squared_dirichlet: {
        const std::vector<double> ones(std::size_t((bands - 1) / 2 + 1), 1.0);
        return factors_of_kernel(bands, [&](double t) {
            const double dirichlet = evaluate_zonal(ones, t);
            return dirichlet * dirichlet;
        });
    }
    }
    return factors;
}

namespace {
constexpr std::array<std::pair<Window, std::string_view>, 5> names = {
    {{Window::none, "none"},
     {Window::hann, "hann"},
     {Window::lanczos, "lanczos"},
     {Window::non_negative, "non-negative"},
     {Window::squared_dirichlet, "squared-dirichlet"}}};
}

std::string_view window_name(Window window) {
    for (const auto& [value, name] : names)
        if (value == window)
            return name;
    return "?";
}

Window window_from_name(std::string_view name) {
    std::string known;
    for (const auto& [value, text] : names) {
        if (text == name)
            return value;
        known += (known.empty() ? "" : ", ") + std::string(text);
    }
    throw InputError("there is no window '" + std::string(name) + "'; choose one of " + known);
}

} // namespace kokage
