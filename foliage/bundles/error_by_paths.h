#pragma once
// The error of a solution as path tracing a sample of its leaf sides shows it.
//
// Halves of the lines show what more lines would mend. What no line mends (light leaves a side as if it were lit
// evenly; inside of wood; the ground's texels) only another method can show, and a mean over leaves needs few of them.
#include "common/environment/environment.h"
#include "common/services/progress.h"
#include "common/trace/ray_queries.h"
#include "foliage/patch_points.h"

#include <memory>
#include <optional>
#include <vector>

namespace kokage::bundles {

struct MeasuredError {
    double error = 0;        ///< MRE (see foliage/accuracy.h)
    double uncertainty = 0;  ///< standard error of `error`, as a share of it; at most 1
    std::uint64_t paths = 0; ///< that were traced for it
};

/// A solution's leaf sides, as leaf_side_radiance() gives them.
struct JudgedSides {
    std::vector<glm::vec3> radiance;
    std::vector<glm::vec3> half_differences; ///< how the sampling error is spread over them; see half_difference.h
};

/// Paths that arrive at both sides of some leaves: radiance by two independent halves of them, two entries a leaf.
struct TracedSides {
    std::vector<std::uint32_t> leaves;
    std::vector<glm::vec3> first, second;
    std::uint32_t paths_a_side = 0;
};

/// The error beneath the noise of few paths. In each class of brightness the mean of |solution - paths| holds error and
/// noise, the mean of half the paths' halves' difference the noise alone; squares of independent means add up. The
/// classes are put together as a ratio of this error to the one that half differences of the lines show, each class
/// weighted by how well it knows: paths are noisy in the dark, where errors are larger, too, and by how much is known
/// of the lines. The mean over all sides of what half differences show, times that ratio, is the error.
MeasuredError error_beneath_noise(const JudgedSides& judged, const TracedSides& traced);

/// Which leaves are traced: evenly spread over the leaves in the order of their area, so that rare sizes are met as
/// often as they are there. Ascending; all if `count` is as many.
std::vector<std::uint32_t> sample_leaves(const std::vector<double>& leaf_areas, std::uint32_t count,
                                         std::uint64_t seed);

/// Keeps the ray structure. The scene must outlive it.
class ErrorByPaths {
  public:
    explicit ErrorByPaths(const PatchScene& scene);
    /// Traces until the uncertainty is 15 %, but not more than 50,000 paths (200,000 while it is above 21 %), and never
    /// fewer than 12,000, whatever the size of the tree (of 192 leaves or more). `max_bounces` as in ShadingOptions. No
    /// leaves: no error.
    /// `traced`: what was traced before of the same light, with other seeds, is used, too, and as many paths a side are
    /// traced at least; what is traced now is added.
    MeasuredError measure(const JudgedSides& judged, const Environment& environment, const std::vector<Optics>& optics,
                          int max_bounces, std::uint64_t seed, TracedSides& traced, Progress& progress);
    std::size_t bytes() const { return queries_.bytes() + points_.bytes(); }

  private:
    const PatchScene& scene_;
    RayQueries queries_;
    PatchPoints points_;
    std::vector<double> leaf_areas_;
};

} // namespace kokage::bundles
