#pragma once
// Shading of small trees by any method, and how near it comes to the truth.
#include "foliage/accuracy.h"
#include "foliage/method.h"
#include "foliage/path_traced.h"
#include "tests/unit/foliage/small_trees.h"

namespace kokage::test {

inline Solution shade(const SmallTree& small, const Environment& environment, const ShadingOptions& options) {
    return make_transport(small.scene, small.tree, options, silent_progress())->solve(environment, silent_progress());
}

/// A crown of 1,000 bright leaves under sky and sun, and the truth about it.
struct JudgedCrown {
    SmallTree crown = ball_on_a_skeleton(1000, 3, bright_leaf());
    PathTracedReference reference;

    explicit JudgedCrown(int paths_per_side)
        : reference(path_trace_reference(crown.scene, sky_and_sun(), paths_per_side, 1, silent_progress())) {}
};

} // namespace kokage::test
