#pragma once
// Cuts a mesh into patches that each carry one radiance: leaves, pieces of bark, or of a scene's objects.
#include "common/types.h"

#include <functional>
#include <span>
#include <vector>

namespace kokage {

struct SurfacePatchLimits {
    float max_turn = 0.5236f; ///< radians between a triangle's normal and its patch's mean normal
    /// Largest radius of a patch (of the disc of its area) around a triangle centroid, in metres.
    std::function<float(const glm::vec3&)> max_radius;
    /// Where a patch may turn all around; empty: nowhere.
    std::function<bool(const glm::vec3&)> whole_rings;
    /// A connected piece of at most two triangles is a leaf card and never cut: its texture holds the leaf.
    bool keep_cards = true;
};

/// The patch of each triangle, numbered by their first triangle: connected (edges between vertices at the same place),
/// cut where it turns or grows beyond the limits. Triangles without area join any neighbour.
std::vector<std::uint32_t> surface_patches(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                                           const SurfacePatchLimits& limits);

} // namespace kokage
