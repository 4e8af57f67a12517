#pragma once
// Final gathering (Reichert 1992), averaged over patches. What the camera sees of a leaf gets more light than the leaf
// in the mean, because neighbours that hide a part from the light hide it from the camera as well. So rays go out from
// points that the camera sees, meet solved radiance, and correct the patch's light: a leaf of a hundred pixels gets
// hundreds of rays for a few a pixel. Private to reflection.
#include "reflection/camera_rays.h"
#include "reflection/gloss_shading.h"
#include "reflection/incoming_radiance.h"
#include "reflection/relief_surfaces.h"
#include "reflection/surface_shading.h"

namespace kokage {

/// Rays a pixel where PictureOptions::gather_rays leaves it open: few beside the picture's own.
int gather_rays(const PictureOptions& options);

/// Corrects the indirect light of `surfaces` and gives `gloss` the light in the lobes of flat, evenly rough patches.
/// Reports rays, or that it was skipped: with no rays, without pixel_shadows, or where nothing is in view. The same bits
/// for any number of threads. Throws Stopped.
void gather_for_camera(const ShadedScene& scene, const ReliefSurfaces& relief, const CameraFrame& frame,
                       const PictureOptions& options, const IncomingRadiance& incoming, const Environment& environment,
                       SurfaceShading& surfaces, GlossShading& gloss, Progress& progress, WorkReport& report);

} // namespace kokage
