#include "common/services/error.h"
#include "reflection/backdrop.h"
#include "reflection/camera_ray_shading.h"
#include "reflection/camera_rays.h"
#include "reflection/final_gather.h"
#include "reflection/gloss_in_view.h"
#include "reflection/gloss_shading.h"
#include "reflection/picture.h"
#include "reflection/picture_drawing.h"
#include "reflection/relief_surfaces.h"
#include "reflection/surface_shading.h"

namespace kokage {

Picture render_picture(const ShadedScene& scene, const RayQueries& queries, const Environment& environment,
                       const Camera& camera, const PictureOptions& options, Progress& progress) {
    check_picture_options(options);
    if (!scene.patches)
        throw InputError("picture: there is no scene of patches");
    if (environment.remainder.empty() || environment.remainder.channels < 3)
        throw InputError("picture: the environment has no image of 3 channels");
    const CameraFrame frame = camera_frame(camera, options.width, options.height);
    const Backdrop backdrop(environment);
    const LightChoice lights(environment, options.light_samples);
    SurfaceShading surfaces(scene, queries, lights, options.pixel_shadows);
    const GroundLook ground(scene, queries, environment, backdrop, camera, options);
    WorkReport report;
    const GroundShading ground_light(scene, queries, environment, backdrop, ground, lights, progress);
    const IncomingRadiance incoming(queries, environment, surfaces, ground, ground_light);
    GlossShading gloss(scene, environment, surfaces, incoming, lobes_to_bake(scene, frame, options.skips, report),
                       progress, report);
    const ReliefSurfaces relief(scene, queries, environment, frame, options.skips.thin_relief, progress, report);
    gather_for_camera(scene, relief, frame, options, incoming, environment, surfaces, gloss, progress, report);
    const CameraRayShading shading{queries, backdrop, lights, surfaces, ground, ground_light, gloss, relief};

    Picture picture = draw_picture(shading, frame, options, progress, report);
    picture.report = report;
    return picture;
}

} // namespace kokage
