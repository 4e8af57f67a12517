#pragma once
// How much memory a picture takes.
#include "reflection/picture.h"

#include <cstdint>
#include <span>

namespace kokage {

/// Bytes that a picture takes while it is drawn by so many threads: its images, and rays under way. Of render_picture,
/// which takes more than render_path_traced.
double picture_bytes(const PictureOptions& options, int threads);

/// Bytes that render_picture's light takes beside: of all patches, of the corners of bark and objects, and what is
/// gathered where the camera looks.
double light_bytes(const PictureOptions& options, const PatchScene& scene, int threads);

/// Bytes that render_picture takes beside to light gloss from light maps of so many bands; `readers`: as
/// light_map_readers.h tells them; empty: no patch reads any.
double light_map_bytes(const PatchScene& scene, std::span<const std::uint8_t> readers, int bands);

} // namespace kokage
