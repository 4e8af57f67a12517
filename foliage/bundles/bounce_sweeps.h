#pragma once
// Light between sides: sparse sweeps over the links until nothing changes any more.
//
//   E(s) = E_outside(s) + pi (1 - open(s)) mean of B over the neighbours of s
//        + pi down(s) mean of (B_ground - B_open_ground)
//
//   B(s) = (rho E(s) + tau E(other side)) / pi
//
// Every row's weights are non-negative and sum to at most 1, so a sweep contracts the largest difference by the largest
// rho + tau. The open share comes from all lines, the neighbours' mean from the link lines: in a furnace (constant
// surroundings, rho + tau = 1) B = 1 solves the equations exactly, whatever the noise of either.
#include "foliage/bundles/scattering.h"

#include <vector>

namespace kokage::bundles {

/// What arrives from outside the tree at every side; all per side.
struct SideLight {
    std::vector<Rgb> irradiance;
    std::vector<float> open; ///< share of its cosine-weighted hemisphere that sees surroundings or ground
    std::vector<float> down; ///< of that, the share of the lower hemisphere
};

/// The same, and what the ground needs, where there is one.
struct OutsideLight : SideLight {
    std::vector<glm::vec3> ground_irradiance; ///< per texel: from lights, with the tree's shadow, and the open sky
    glm::vec3 open_ground_irradiance{0.f};    ///< of ground that lies open
    std::vector<glm::vec3> near_radiance;     ///< per link direction: what the tree hides from the ground
};

struct SweepLimits {
    double tolerance = 0.005; ///< stop when the light still missing is below this share of the whole
    int max_bounces = 0;      ///< 0 = until the tolerance; else exactly that many plain sweeps, from black
};

struct SweepResult {
    std::vector<Rgb> radiance;     ///< B per side
    std::vector<double> residuals; ///< per sweep: largest change of a side over the largest radiance
    std::vector<Rgb>
        from_ground; ///< per side: mean of (B_ground - B_open_ground) over its lines to the ground; empty without
};

/// What the two halves of the directions make of the same light.
struct HalvesResult {
    std::vector<Rgb> half_difference; ///< per side: half of what their radiances differ by
    std::vector<Rgb> irradiance;      ///< per side: the mean of theirs
};

class BounceOperator {
  public:
    BounceOperator(const PatchScene& scene, const BundleTransport& transport);
    /// Iterates from `start` if it is as long, else from a guess; from black when bounces are counted.
    SweepResult solve(const OutsideLight& outside, const std::vector<Optics>& optics, const SweepLimits& limits,
                      const std::vector<Rgb>& start);
    /// One more scattering with the neighbours and the outside light of each half of the directions.
    HalvesResult scatter_by_halves(const SideLight (&outside)[2], const std::vector<Optics>& optics,
                                   const SweepResult& light);

    /// Scales what has bounced so that its mean is free of what lines shared between bounces add. i sees j along a
    /// line, and the same line tells what j sees: i itself, and what lies behind j. Of the directions that light takes
    /// to i through j these are too large a part, O(1 / lines), so crowns of little absorption come out a little
    /// wrong. With the rows K_A, K_B of the halves and D half of what they make differ, a bounce has -1/2 (K_A - K_B)
    /// D too much or too little: in K_A X_B and K_B X_A no line is used twice.
    void remove_shared_lines(const SideLight (&outside)[2], const std::vector<Optics>& optics,
                             const std::vector<Rgb>& half_difference, SweepResult& light);
    /// Adds to a difference between two solutions its first scattering: what an error does to the light around it.
    void spread(const std::vector<float>& open, const std::vector<Optics>& optics, std::vector<Rgb>& difference);
    /// The share of light that a bounce hands on, at most: the largest albedo times the mean closed share.
    double mean_survival(const SideLight& outside, const std::vector<Optics>& optics) const;

  private:
    std::vector<glm::vec3> light_ground(const OutsideLight& outside, const std::vector<Rgb>& radiance) const;
    std::vector<Rgb> gather_ground(const std::vector<glm::vec3>& ground_excess) const;
    void add_ground(const SideLight& outside, const std::vector<Rgb>& from_ground, std::vector<Rgb>& irradiance) const;
    void iterate(const OutsideLight& outside, const std::vector<Optics>& optics, const SweepLimits& limits,
                 SweepResult& result);
    void guess(const OutsideLight& outside, const std::vector<Optics>& optics, SweepResult& result);
    void emit(const OutsideLight& outside, const std::vector<Optics>& optics, SweepResult& result, bool ground);
    const std::vector<float>& weights_for(const std::vector<float>& open);

    const PatchScene& scene_;
    const BundleTransport& transport_;
    std::vector<float> ground_links_; ///< per side: number of links to the ground
    std::vector<float> weighed_open_; ///< what weights_ were made for
    std::vector<float> weights_;
    std::vector<Rgb> emitted_;    ///< per side, by the last solve(): light from outside, scattered once
    std::vector<Rgb> scratch_[2]; ///< per side
};

} // namespace kokage::bundles
