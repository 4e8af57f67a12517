#pragma once
// Traces the rays of patches that are too small or too wide for line bundles (see ray_links.h).
#include "common/trace/ray_queries.h"
#include "foliage/bundles/bundle_tracing.h"
#include "foliage/patch_points.h"

namespace kokage::bundles {

/// Leaf patches that lines are bound to miss: by their solid area they can expect less than a sixteenth of the link
/// lines that a leaf of mean area should get, or fewer than 8 lines a side and less than a quarter. Not those that
/// chance gave few lines. Ascending.
std::vector<std::uint32_t> leaves_too_small_for_lines(const PatchScene& scene, const Facets& facets,
                                                      const BundleSettings& settings);

/// Rays of a small leaf's side, both halves together, that go with bundles of these settings; a multiple of 2.
std::uint32_t rays_a_side(const BundleSettings& settings);

/// Traces the leaves `small` (ascending) and facets.wide_patches, and puts what they meet into their rows of
/// transport.links; sets transport.rays. Patches without solid area keep what lines found. The result does not depend
/// on the number of threads. `earlier`: a transport of the same scene and seed with fewer rays, which are then not
/// traced again (empty: none); the result is the same.
void add_ray_links(const RayQueries& queries, const PatchPoints& points, const Facets& facets,
                   const std::vector<std::uint32_t>& small, std::uint32_t rays_a_side, std::uint64_t seed,
                   const BundleTransport& earlier, BundleTransport& transport, Progress& progress);

} // namespace kokage::bundles
