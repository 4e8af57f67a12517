#pragma once
// Rotation of functions that are given by spherical harmonics.
#include "common/directions/spherical_harmonics.h"

#include <Eigen/Core>
#include <span>
#include <vector>

namespace kokage {

/// The matrices, one a band, that rotate coefficients: (rotated f)(d) = f(R^-1 d).
/// Ivanic and Ruedenberg, J. Phys. Chem. 1996, 100, 6342, with the additions and corrections of 1998, 102, 9099: a
/// recurrence from band to band, of the entries of R alone.
class ShRotation {
  public:
    /// `rotation`: orthogonal with determinant +1 (columns are the images of the axes). Memory and time grow with
    /// bands^3.
    ShRotation(const glm::dmat3& rotation, int bands);

    int bands() const { return int(matrices_.size()); }
    /// (2l+1) x (2l+1), row and column l + m.
    const Eigen::MatrixXd& matrix(int l) const { return matrices_[std::size_t(l)]; }
    /// In place; bands^2 coefficients, at most the bands that it was made for.
    void apply(std::span<glm::vec3> coefficients) const;
    void apply(std::span<double> coefficients) const;

  private:
    std::vector<Eigen::MatrixXd> matrices_;
};

} // namespace kokage
