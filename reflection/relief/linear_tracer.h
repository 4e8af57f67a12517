#pragma once
// The peer that most programs use: equal steps, then bisection. F. Policarpo, M. M. Oliveira, J. L. D. Comba, Real-Time
// Relief Mapping on Arbitrary Polygonal Surfaces (2005).
#include "reflection/relief/relief_tracer.h"

namespace kokage {

struct LinearSearch {
    int steps = 64;     ///< from where the ray enters to where it leaves: equal ones of depth; 1 to 65536
    int bisections = 6; ///< 0 to 32
};

/// Thin features between two steps are passed, the more the flatter the ray. Vector code of single precision; rays with
/// numbers beyond it (components above 1e9, 2^20 texels away, all denormal) are traced cell by cell. A step reads one
/// 2 x 2 cell, and so does a bisection. `field` is kept by reference. Throws InputError for other numbers, and for
/// fields of more than 32767 texels on a side.
std::unique_ptr<ReliefTracer> make_linear_tracer(const HeightField& field, const LinearSearch& search = {});

} // namespace kokage
