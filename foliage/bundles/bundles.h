#pragma once
// The `bundles` method: line bundles, solved in full as a sparse operator (DESIGN 4).
#include "foliage/bundles/bundle_tracing.h"
#include "foliage/method.h"

namespace kokage {

/// Everything that `--effort` and `--error` decide for `bundles`.
struct BundleEffort {
    bundles::BundleSettings lines;
    int beams_per_light = 4;  ///< for one light; many lights share them out by power
    float beam_pixels = 64;   ///< mean pixels a leaf
    double tolerance = 0.001; ///< of the sweeps
};

std::unique_ptr<Transport> make_bundles_transport(const PatchScene& scene, const Tree& tree,
                                                  const ShadingOptions& options, Progress& progress);
/// With the effort given outright (benchmarks, tests).
std::unique_ptr<Transport> make_bundles_transport(const PatchScene& scene, const BundleEffort& effort,
                                                  const ShadingOptions& options, Progress& progress);

} // namespace kokage
