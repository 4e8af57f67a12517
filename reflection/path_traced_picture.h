#pragma once
// The truth of a picture: camera rays, textures, smooth normals and gloss of render_picture, with every light path
// between them traced.
#include "reflection/picture.h"

namespace kokage {

/// What render_picture draws, by path tracing: all bounces between patches and ground (Russian roulette alone ends
/// them), lights and the remainder sampled, gloss (gloss.h) sampled by its lobe at every vertex. Solved radiance in
/// `scene` is not read. The ground is the scene's own, or as PictureGround says: of a backdrop that plays the
/// ground the first on a path is lit as the scene lets it (backdrop_ground.h). `options.samples` paths a pixel;
/// light_samples and pixel_shadows are not used. The same bits for any number of threads. Throws InputError, Stopped.
Picture render_path_traced(const ShadedScene& scene, const RayQueries& queries, const Environment& environment,
                           const Camera& camera, const PictureOptions& options, Progress& progress);

} // namespace kokage
