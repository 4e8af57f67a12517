#pragma once
// How much memory a picture takes.
#include "reflection/picture.h"

namespace kokage {

/// Bytes that a picture takes while it is drawn by so many threads: its images, and rays under way. Of render_picture,
/// which takes more than render_path_traced.
double picture_bytes(const PictureOptions& options, int threads);

} // namespace kokage
