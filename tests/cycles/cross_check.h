#pragma once
// Our path tracer against Cycles: the same scene, how far apart.
#include "tests/cycles/cross_check_scenes.h"
#include "tests/cycles/cycles_picture.h"

namespace kokage {

struct CrossCheck {
    SurfaceLight ours, cycles;
    /// Per channel: mean radiance of surfaces over the picture, ours over Cycles', less 1.
    glm::dvec3 difference{0.0};
    glm::dvec3 noise{0.0};          ///< of `difference`: one standard deviation, from pairs of pictures
    double coverage = 0;            ///< ours: mean share of the picture that shows surfaces
    double coverage_difference = 0; ///< over Cycles', less 1
    double our_cpu_seconds = 0, cycles_cpu_seconds = 0; ///< Cycles': with Blender's start and the making of its scene
};

/// Two pictures of half the samples by each. What is seen beside and between surfaces is no part of either: ours is
/// rendered once more with black surfaces, whose rays are the same, and the difference taken. A scene's infinite ground
/// must not be in view.
CrossCheck cross_check(const CrossCheckScene& scene, const CyclesOptions& options, const std::filesystem::path& folder);

} // namespace kokage
