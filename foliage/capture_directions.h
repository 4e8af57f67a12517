#pragma once
// The directions in which a light map looks around: Gauss-Legendre rings around +Y, so that whatever the map keeps is
// integrated exactly.
#include "common/scene/image.h"
#include "common/types.h"

#include <cstddef>
#include <vector>

namespace kokage {

/// A product quadrature of the sphere, which also cuts it into cells: `rings` Gauss-Legendre nodes in cos(angle from
/// +Y), from the top, times per_ring = 2 rings equal steps of azimuth. Exact for spherical harmonics up to degree 2
/// rings - 1, whatever their polar axis. Each node lies in a cell of exactly its weight's solid angle (for Gauss nodes:
/// the Chebyshev-Markov-Stieltjes inequalities).
struct CaptureDirections {
    int rings = 0, per_ring = 0;
    std::vector<glm::vec3> directions; ///< ring by ring; azimuth as in lat-long images, u = (j + 1/2)/per_ring
    std::vector<float> solid_angles;   ///< sr, as long as directions; they add up to 4pi
    std::vector<double> borders;       ///< rings + 1 falling cosines from 1 to -1

    std::size_t size() const { return directions.size(); }
    /// Index of the cell that holds a unit direction.
    std::size_t cell(const glm::vec3& direction) const;
};

/// At least `least_count` directions, and enough for products of two functions of `bands` bands.
CaptureDirections make_capture_directions(int bands, int least_count);

/// Mean radiance of a lat-long image over every cell, by exact areas of overlap: energy is kept whatever the sizes.
std::vector<glm::vec3> cell_means(const CaptureDirections& directions, const Image& lat_long);

} // namespace kokage
