#pragma once
// Light between sides: sparse sweeps over the links until nothing changes any more.
//
//   E(s) = E_outside(s) + pi (1 - open(s)) mean of B over the neighbours of s + pi down(s) mean of (B_ground -
//   B_open_ground) B(s) = (rho E(s) + tau E(other side)) / pi
//
// Every row's weights are non-negative and sum to at most 1, so a sweep contracts the largest difference by the largest
// rho + tau. The open share comes from all lines, the neighbours' mean from the link lines: in a furnace (constant
// surroundings, rho + tau = 1) B = 1 solves the equations exactly, whatever the noise of either.
#include "foliage/bundles/bundle_tracing.h"

#include <vector>

namespace kokage::bundles {

/// RGB and a pad, so that a side is one aligned vector.
struct alignas(16) Rgb {
    float r = 0, g = 0, b = 0, pad = 0;
    glm::vec3 vec() const { return {r, g, b}; }
    static Rgb from(const glm::vec3& v) { return {v.x, v.y, v.z, 0}; }
};

/// What arrives from outside the tree at every side.
struct OutsideLight {
    std::vector<Rgb> irradiance; ///< per side
    std::vector<float> open;     ///< per side: share of its cosine-weighted hemisphere that sees surroundings or ground
    std::vector<float> down;     ///< of that, the share of the lower hemisphere
    // With a ground:
    std::vector<glm::vec3>
        ground_irradiance;                 ///< per texel: from lights, with the tree's shadow, and the whole open sky
    glm::vec3 open_ground_irradiance{0.f}; ///< of ground that lies open
    std::vector<glm::vec3> near_radiance;  ///< per link direction: what the tree hides from the ground
};

struct SweepLimits {
    double tolerance = 0.005; ///< stop when the light still missing is below this share of the whole
    int max_bounces = 0;      ///< 0 = until the tolerance; else exactly that many bounces at most
};

struct SweepResult {
    std::vector<Rgb> radiance;     ///< B per side
    std::vector<double> residuals; ///< per sweep: largest change of a side over the largest radiance
    std::vector<Rgb>
        from_ground; ///< per side: mean of (B_ground - B_open_ground) over its lines to the ground; empty without
};

class BounceOperator {
  public:
    BounceOperator(const PatchScene& scene, const BundleTransport& transport);
    /// Iterates from the first scattering of the outside light (or from `start`, if it is as long).
    SweepResult solve(const OutsideLight& outside, const std::vector<Optics>& optics, const SweepLimits& limits,
                      const std::vector<Rgb>& start) const;
    /// One more scattering with the neighbours of one half of the directions only (0 or 1), or of both (-1).
    /// `irradiance`, if given, receives E per side.
    std::vector<Rgb> scatter(const OutsideLight& outside, const std::vector<Optics>& optics, const SweepResult& light,
                             int half, std::vector<Rgb>* irradiance = nullptr) const;

    /// Takes out of a solution what lines echo. A line from i to j stands in both rows, so light that went along it
    /// comes back along it more often than chance would have it, and crowns of little absorption turn out too bright by
    /// O(1 / lines). Corrected to first order: each row sees its neighbour's radiance as the neighbour's other lines
    /// give it.
    void remove_echoes(const OutsideLight& outside, const std::vector<Optics>& optics, SweepResult& light) const;
    /// The first `orders` scatterings of differences between two solutions: what an error does to the light around it.
    std::vector<Rgb> spread(const OutsideLight& outside, const std::vector<Optics>& optics,
                            const std::vector<Rgb>& difference, int orders) const;

  private:
    std::vector<glm::vec3> light_ground(const OutsideLight& outside, const std::vector<Rgb>& radiance) const;
    std::vector<Rgb> gather_ground(const std::vector<glm::vec3>& ground_excess) const;

    const PatchScene& scene_;
    const BundleTransport& transport_;
    std::vector<float> ground_links_; ///< per side: number of links to the ground
};

} // namespace kokage::bundles
