#pragma once
// How much of a patch the camera sees, of what it would see if nothing stood before it. Private to reflection.
#include "common/scene/patch_scene.h"
#include "reflection/camera_rays.h"

namespace kokage {

/// Pixels that a side of a patch would cover; holes of masks count as leaf.
double pixels_of_patch(const PatchScene& scene, const Patch& patch, bool front, const CameraFrame& frame);

} // namespace kokage
