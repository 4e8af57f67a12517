#pragma once
// The method `path-traced`: the truth that the other methods are held against.
#include "foliage/method.h"

#include <memory>
#include <vector>

namespace kokage {

/// Paths a leaf side = options.effort (rounded up to an even number), or as many as options.error asks for, found by a
/// pilot. All bounces unless options.max_bounces says otherwise; the other options are not used. estimated_error is
/// deduced from two independent halves of the paths. Kept between solves: the ray structure. Each solve traces anew.
std::unique_ptr<Transport> make_path_traced_transport(const PatchScene& scene, const Tree& tree,
                                                      const ShadingOptions& options, Progress& progress);

/// What the other methods are judged by: leaves only.
struct PathTracedReference {
    std::vector<glm::vec3> sides;         ///< radiance of leaf sides as leaf_side_radiance() gives them, of all paths
    std::vector<glm::vec3> first, second; ///< of either half of the paths, independent of each other
    double noise = 0;                     ///< MRE of `sides` against the truth, deduced from the halves
    std::uint32_t paths_per_side = 0;     ///< of both halves together
};

/// Traces `paths_per_side` paths (rounded up to an even number) for both sides of every leaf.
PathTracedReference path_trace_reference(const PatchScene& scene, const Environment& environment,
                                         std::uint32_t paths_per_side, std::uint64_t seed, Progress& progress);

/// Mean of two references of the same scene that were made with different seeds: to go on where a stored one ended.
/// Throws InputError if their sizes differ.
PathTracedReference merge_references(const PathTracedReference& a, const PathTracedReference& b);

} // namespace kokage
