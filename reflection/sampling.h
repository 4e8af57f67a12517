#pragma once
// Well-spread sample points whose value depends on (index, count, pattern) alone, so that any thread can make any of
// them.
#include "common/types.h"

namespace kokage {

/// Point `index` of a correlated multi-jittered set of `count` points in [0,1)^2 (Kensler, "Correlated Multi-Jittered
/// Sampling", Pixar Technical Memo 13-01, 2013). Different patterns are independent, also in the order of their points.
glm::vec2 multi_jittered(std::uint32_t index, std::uint32_t count, std::uint32_t pattern);

/// Point `index` of an endless sequence in [0,1)^2 whose first points are spread evenly, however many: Roberts' R2
/// ("The Unreasonable Effectiveness of Quasirandom Sequences", 2018), shifted as the pattern says.
/// Costs two multiplications where multi_jittered() permutes three times.
glm::vec2 evenly_spread(std::uint32_t index, std::uint32_t pattern);

/// Point `index` of `count` jittered strata of [0,1), in an order that depends on the pattern.
float stratified(std::uint32_t index, std::uint32_t count, std::uint32_t pattern);

/// Of the lowest 16 bits of both: places in a row along the curve lie together (Morton 1966).
std::uint32_t place_on_curve(std::uint32_t x, std::uint32_t y);

/// Cosine-distributed direction about +Y from a point of the unit square, by the concentric map (Shirley and Chiu
/// 1997).
glm::vec3 cosine_direction(glm::vec2 u);

/// Offset in pixels, within +-1.5, distributed as the Blackman-Harris window: drawing camera rays by it filters the
/// picture with that window, without negative lobes and without neighbours sharing samples (filter importance sampling,
/// Ernst et al. 2006).
float pixel_filter_offset(float u);

/// That window, at an offset in pixels; its integral is 1.
float pixel_filter(float offset);

/// Weights of the four nodes round a place at fraction t between the second and the third: the uniform cubic B-spline.
/// It is smooth, never negative, and sums to 1.
glm::vec4 cubic_b_spline(float t);

} // namespace kokage
