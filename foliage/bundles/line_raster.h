#pragma once
// Draws all facets in parallel projection along a direction: one pixel is one line through the scene.
//
//   near end (where light comes from first)      v ^     The picture plane has axes u, v in pixels; depth grows along
//        |   |   |   |   lines                     |     the direction. Pixel centres are at integers. A polygon covers
//        v   v   v   v   along `direction`         +--> u  a pixel if its centre is inside (left/low edges included).
//      ------- facets -------
//   far end
//
// Two products, both exact per pixel: the nearest and farthest face (KeyBuffers), or every face (FragmentLists).
// A key is depth (high bits) | face (low bits), so that keys sort by depth.
#include "foliage/bundles/facets.h"
#include "foliage/bundles/fragment_lists.h"

#include <cstdint>
#include <vector>

namespace kokage::bundles {

/// A parallel projection. All lengths in scaled units of Facets.
struct Projection {
    glm::vec3 u_axis, v_axis, direction; ///< orthonormal, u x v = -direction
    float pixels_per_unit = 1;
    glm::vec2 offset{0.f};               ///< in pixels; jitters the grid and moves everything to positive coordinates
    int width = 0, height = 0;           ///< the width is a multiple of FragmentLists::kGroup
    float depth_low = 0, depth_high = 1; ///< in pixels along the direction
    bool clips = false;                  ///< polygons may reach out of the picture, or lie outside
};

/// Fits a projection along a unit direction around a scene (around all but its wide patches); `jitter` in [0,1)^2 moves
/// the grid.
Projection fit_projection(const Facets& facets, const glm::vec3& direction, float pixels_per_unit, glm::vec2 jitter);

/// How many low bits of a key hold the face. Face counts above 2^20 leave fewer depth levels than the 4096 that are
/// enough.
int face_bits(const Facets& facets);

inline constexpr std::uint32_t kNoKey = 0xffffffffu;

/// Reusable memory of one thread.
struct RasterScratch {
    std::vector<std::uint32_t> near_keys, far_keys;   ///< width x height; kNoKey / 0 = empty
    std::vector<std::uint32_t> fragments;             ///< of every face: pixels covered solidly
    std::vector<std::uint32_t> near_count, far_count; ///< of every face: pixels where it is the nearest / farthest one
    // Fragment lists
    std::vector<std::uint32_t> fragment_pixel, fragment_key; ///< in drawing order
    FragmentLists lists;                                     ///< of width x height pixels
    std::size_t fragment_count = 0;
};

/// Nearest (and, if `both`, farthest) solid face of each pixel, and the fragments of each face.
void draw_ends(const PatchScene& scene, const Facets& facets, const Projection& projection, bool both,
               RasterScratch& scratch);

/// Every solid fragment of each pixel in order of depth, scratch.lists; and the counts as above.
void draw_fragments(const PatchScene& scene, const Facets& facets, const Projection& projection,
                    RasterScratch& scratch);

} // namespace kokage::bundles
