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

/// Corrects the indirect light of `surfaces` where the camera sees it, by PictureOptions::gather_rays, and gives
/// `gloss` the light in the lobes of flat, evenly rough patches. Reports the rays, or that it was skipped because
/// shadows are not tested per pixel: then solved light has the lights' own in it. The same bits for any number of
/// threads. Throws Stopped.
void gather_for_camera(const ShadedScene& scene, const ReliefSurfaces& relief, const CameraFrame& frame,
                       const PictureOptions& options, const IncomingRadiance& incoming, const Environment& environment,
                       SurfaceShading& surfaces, GlossShading& gloss, Progress& progress, WorkReport& report);

/// Bytes that this takes at most, of a scene of so many patches and corners of smooth surfaces, with what pictures keep
/// of it; 0 without gathering rays.
double gathering_bytes(const PictureOptions& options, double patches, double corners, int threads);

} // namespace kokage
