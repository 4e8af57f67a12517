#pragma once
// The crowns of the benchmark. They do not depend on the species generator, so that figures of today and of next year
// are about the same tree.
#include "trees/tree.h"

#include <vector>

namespace kokage {

/// Total one-sided leaf area of every benchmark crown, over the area of its ground projection.
inline constexpr double kBenchLeafAreaIndex = 3.5;

/// A broadleaf tree about 12 m tall standing at the origin: trunk, limbs, branches and leaf-bearing twigs inside a
/// dome, leaves as flat kites of two triangles clustered on the twigs, tilted at random with a bias upwards. The same
/// trunk, limbs and branches for any number of leaves; more leaves stand on more and finer twigs and are smaller, so
/// that the leaf area is kBenchLeafAreaIndex x ground_projection_area(). leaves >= 1.
///
/// The bytes are the same on any machine: shapes are computed in double without sines, powers and the like,
/// randomness is hashed, and positions are rounded to 2^-18 m.
Tree make_bench_crown(std::uint32_t leaves, std::uint64_t seed);

/// Area in m^2 of the convex hull of the leaf centres seen from above.
double ground_projection_area(const std::vector<Leaf>& leaves);

/// Total one-sided area in m^2 of a tree's foliage parts (holes of alpha masks are not taken out).
double foliage_area(const Tree& tree);

} // namespace kokage
