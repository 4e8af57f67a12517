#pragma once
// From samples of a function on the sphere to its spherical-harmonic coefficients.
#include "common/directions/spherical_harmonics.h"
#include "common/scene/image.h"

#include <span>
#include <vector>

namespace kokage {

/// Coefficients of a lat-long image (lat_long.h; at least 3 channels) whose pixels are patches of constant radiance:
/// the harmonics are integrated over each pixel, not sampled at its centre, so a constant image has no coefficient but
/// the first, and a 1 x 1 image is as exact as a large one. Rows are transformed by FFT, then each order m is summed
/// over the rows. Same bits with any number of threads.
std::vector<glm::vec3> project_lat_long(const Image& image, int bands);

/// Coefficients = sum of weights[i] Y(directions[i]) values[i]: Monte Carlo or quadrature with weights in sr
/// (sphere_sets.h). Sizes must agree.
std::vector<glm::vec3> project_samples(std::span<const glm::vec3> directions, std::span<const glm::vec3> values,
                                       std::span<const double> weights, int bands);

/// The coefficients that meet the samples best: least weighted squares, by Householder QR (Eigen). Directions may lie
/// anywhere, but there must be at least bands^2 of them in general position; otherwise throws std::invalid_argument.
/// `weights` empty = all 1, else not negative.
std::vector<glm::vec3> fit_samples(std::span<const glm::vec3> directions, std::span<const glm::vec3> values,
                                   std::span<const double> weights, int bands);

} // namespace kokage
