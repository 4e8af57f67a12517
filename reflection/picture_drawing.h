#pragma once
// A picture's camera rays: first ones, as many more as the plan gives each square (sample_plan.h), and coverage rays
// (film.h). Private to reflection.
#include "reflection/camera_ray_shading.h"

namespace kokage {

/// `report` gets the numbers of rays. The same bits for any number of threads. Throws Stopped.
Picture draw_picture(const CameraRayShading& shading, const CameraFrame& frame, const PictureOptions& options,
                     Progress& progress, WorkReport& report);

} // namespace kokage
