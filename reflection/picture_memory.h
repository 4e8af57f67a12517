#pragma once
// How much memory a picture takes.
#include "reflection/picture.h"

namespace kokage {

/// Bytes that a picture takes while it is drawn by so many threads: its images, and rays under way. Of render_picture,
/// which takes more than render_path_traced.
double picture_bytes(const PictureOptions& options, int threads);

/// Bytes that render_picture's light takes beside: of all patches, of the corners of bark and objects, and what is
/// gathered where the camera looks.
double light_bytes(const PictureOptions& options, const PatchScene& scene, int threads);

} // namespace kokage
