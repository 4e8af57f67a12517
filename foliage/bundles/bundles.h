#pragma once
// The `bundles` method: line bundles, solved in full as a sparse operator.
//
//   facets -> bundle tracing -> [sky + drawn lights = outside light] -> bounce sweeps -> solution
//             (who sees whom)   (per environment)                      (per environment or optics)
#include "foliage/bundles/effort.h"
#include "foliage/method.h"

namespace kokage {

/// options.effort = directions of lines, or as many as options.error asks for: the solution's own estimate decides, and
/// the first solve may draw the bundles again with more. Below what one radiance a leaf side can reach, leaves are
/// divided.
std::unique_ptr<Transport> make_bundles_transport(const PatchScene& scene, const Tree& tree,
                                                  const ShadingOptions& options, Progress& progress);
/// Starts with the given effort, and draws more lines until options.error is reached (tests).
std::unique_ptr<Transport> make_refined_bundles_transport(const PatchScene& scene, const BundleEffort& first,
                                                          const ShadingOptions& options, Progress& progress);
/// With the effort given outright (tests).
std::unique_ptr<Transport> make_bundles_transport(const PatchScene& scene, const BundleEffort& effort,
                                                  const ShadingOptions& options, Progress& progress);

} // namespace kokage
