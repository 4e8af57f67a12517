#include "common/directions/rotation.h"

#include <cmath>
#include <stdexcept>

namespace kokage {
namespace {

/// Ivanic and Ruedenberg, tables 1 and 2 (as corrected in 1998). `one` is band 1's matrix, `last` that of band l-1;
/// both are indexed from -l.
class BandStep {
  public:
    BandStep(const Eigen::MatrixXd& one, const Eigen::MatrixXd& last, int l) : one_(one), last_(last), l_(l) {}

    double entry(int m, int n) const {
        const double denominator = std::abs(n) == l_ ? 2.0 * l_ * (2 * l_ - 1) : double(l_ + n) * (l_ - n);
        const int delta = m == 0, a = std::abs(m);
        const double u = std::sqrt(double(l_ + m) * (l_ - m) / denominator);
        const double v = 0.5 * std::sqrt((1.0 + delta) * (l_ + a - 1) * (l_ + a) / denominator) * (1 - 2 * delta);
        const double w = -0.5 * std::sqrt(double(l_ - a - 1) * (l_ - a) / denominator) * (1 - delta);
        double sum = 0;
        if (u != 0)
            sum += u * product(0, m, n);
        if (v != 0)
            sum += v * v_term(m, n);
        if (w != 0)
            sum += w * w_term(m, n);
        return sum;
    }

  private:
    double r(int i, int j) const { return one_(i + 1, j + 1); }
    double before(int m, int n) const { return last_(m + l_ - 1, n + l_ - 1); }
    double product(int i, int m, int n) const {
        if (n == l_)
            return r(i, 1) * before(m, l_ - 1) - r(i, -1) * before(m, -l_ + 1);
        if (n == -l_)
            return r(i, 1) * before(m, -l_ + 1) + r(i, -1) * before(m, l_ - 1);
        return r(i, 0) * before(m, n);
    }
    double v_term(int m, int n) const {
        if (m == 0)
            return product(1, 1, n) + product(-1, -1, n);
        if (m > 0)
            return m == 1 ? std::sqrt(2.0) * product(1, 0, n) : product(1, m - 1, n) - product(-1, -m + 1, n);
        return m == -1 ? std::sqrt(2.0) * product(-1, 0, n) : product(1, m + 1, n) + product(-1, -m - 1, n);
    }
    double w_term(int m, int n) const {
        if (m > 0)
            return product(1, m + 1, n) + product(-1, -m - 1, n);
        return product(1, m - 1, n) - product(-1, -m + 1, n);
    }

    const Eigen::MatrixXd &one_, &last_;
    int l_;
};

} // namespace

ShRotation::ShRotation(const glm::dmat3& rotation, int bands) {
    if (bands > 0)
        matrices_.push_back(Eigen::MatrixXd::Ones(1, 1));
    if (bands > 1) {
        // Band 1 is (y, z, x): the matrix itself with its axes in that order.
        constexpr glm::length_t axis[3] = {1, 2, 0};
        Eigen::MatrixXd one(3, 3);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                one(i, j) = rotation[axis[j]][axis[i]]; // glm: [column][row]
        matrices_.push_back(one);
    }
    for (int l = 2; l < bands; ++l) {
        const BandStep step(matrices_[1], matrices_.back(), l);
        Eigen::MatrixXd next(2 * l + 1, 2 * l + 1);
        for (int m = -l; m <= l; ++m)
            for (int n = -l; n <= l; ++n)
                next(l + m, l + n) = step.entry(m, n);
        matrices_.push_back(std::move(next));
    }
}

void ShRotation::apply(std::span<double> coefficients) const {
    const int count = sh_bands(coefficients.size());
    if (count > bands())
        throw std::invalid_argument("ShRotation: more bands than it was made for");
    for (int l = 0; l < count; ++l) {
        Eigen::Map<Eigen::VectorXd> band(coefficients.data() + sh_index(l, -l), 2 * l + 1);
        band = (matrices_[std::size_t(l)] * band).eval();
    }
}

void ShRotation::apply(std::span<glm::vec3> coefficients) const {
    std::vector<double> channel(coefficients.size());
    for (glm::length_t c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < channel.size(); ++i)
            channel[i] = double(coefficients[i][c]);
        apply(std::span<double>(channel));
        for (std::size_t i = 0; i < channel.size(); ++i)
            coefficients[i][c] = float(channel[i]);
    }
}

} // namespace kokage
