#pragma once
// How much work an asked error needs, and which lights are worth how much of it.
#include "common/environment/environment.h"
#include "foliage/bundles/bundle_tracing.h"

namespace kokage {

/// What one radiance a leaf side costs however many lines are drawn (an MRE): light leaves a side as if it were lit
/// evenly. It is 0.9 ... 2.5 % in ordinary crowns, of which ModelError assumes this; in other scenes, and where lines
/// are many, it measures. Leaves in four parts have about half of it.
inline constexpr double kUniformSideError = 0.011;

/// Everything that `--effort` and `--error` decide for `bundles`.
struct BundleEffort {
    bundles::BundleSettings lines;
    int light_samples =
        256; ///< pixels a leaf, over all beams of one light that gives all the light; lights share them by irradiance
    double tolerance = 0.003;                      ///< of the sweeps
    double uniform_side_error = kUniformSideError; ///< assumed where it is not measured
};

namespace bundles {

/// Mean of rho + tau over the leaves and channels: how much of the error bounces bring.
double mean_leaf_albedo(const PatchScene& scene);
/// The effort of `directions` lines, lights in proportion. Of 20 lines, 9 only show their ends where leaves are dark
/// (mean albedo 0.3 or less) and 3 where they are bright (0.9 or more): links carry the bounces. Measured to be about
/// the best on the benchmark's 30k crowns, realistic (where any share from 0.3 to 0.7 is as good) and bright.
BundleEffort effort_of_directions(int directions, double leaf_albedo, std::uint64_t seed);
/// The directions that a sampling error (an MRE) is expected to need; the solution's own estimate then decides.
int directions_for_error(double sampling_error, double leaf_albedo);
/// The other way round: the sampling error of an effort under sky and sun.
double usual_sampling_error(const BundleEffort& effort, double leaf_albedo);

/// How one distant light is drawn.
struct LightEffort {
    std::size_t light = 0; ///< index in Environment::distant_lights
    int beams = 2;
    float pixels = 4;          ///< a leaf and beam
    glm::vec3 irradiance{0.f}; ///< its own and that of lights that were merged into it
};

struct LightPlan {
    std::vector<LightEffort> drawn;
    std::size_t merged = 0;  ///< lights too weak to be drawn by themselves
    double merged_share = 0; ///< of all irradiance
};

/// Shares samples among lights by irradiance (which makes the summed variance least), those of a narrow light among few
/// beams of many pixels, those of a wide one among many beams; lights that together give less
/// than `negligible` of all light are merged into their nearest neighbours.
LightPlan plan_lights(const Environment& environment, const BundleEffort& effort, double negligible);

} // namespace bundles
} // namespace kokage
