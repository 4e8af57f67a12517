#pragma once
// The truth: every cell under a ray in its order, and the exact root of the quadratic that a ray and a bilinear cell
// make, in double precision.
#include "reflection/relief/relief_tracer.h"

namespace kokage {

/// One ray against one height field. `reads` counts the cells.
struct TrueReliefHit {
    double t = std::numeric_limits<double>::infinity();
    glm::dvec2 coordinate{0.}; ///< as ReliefHit
    double depth = 0;
    glm::dvec2 slope{0.};
    std::uint32_t reads = 0;

    bool found() const { return t < std::numeric_limits<double>::infinity(); }
};
TrueReliefHit true_relief_hit(const HeightField& field, const ReliefRay& ray);

/// How far the ray gets below the surface (in depth; negative: how near it comes to it from above) at most, between t0
/// and t1: tells ties, rays that graze the surface within rounding, from wrong hits.
double greatest_depth_below(const HeightField& field, const ReliefRay& ray, double t0, double t1);

/// `field` is kept by reference.
std::unique_ptr<ReliefTracer> make_cell_by_cell_tracer(const HeightField& field);

} // namespace kokage
