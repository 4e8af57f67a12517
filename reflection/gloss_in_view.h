#pragma once
// Which lobes a picture's surfaces have, as far as its camera may see them. Private to reflection.
#include "common/services/work_report.h"
#include "reflection/camera_rays.h"

namespace kokage {

/// The roughness of all glossy looks that a camera of this frame may see; least > most where there are none. Mirrored
/// things show no gloss of their own (gloss_shading.h), so what is out of view needs no lobes.
RoughnessBounds roughness_in_view(const ShadedScene& scene, const CameraFrame& frame);

/// The lobes that have to be baked: those, or, where `skips` says so, all from a quarter (or the least in view, if that
/// is less) to 1. Empty: none; the report tells why.
std::optional<RoughnessBounds> lobes_to_bake(const ShadedScene& scene, const CameraFrame& frame,
                                             const PictureSkips& skips, WorkReport& report);

} // namespace kokage
