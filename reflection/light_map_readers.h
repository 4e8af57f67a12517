#pragma once
// Which patches of a picture would light their gloss from light maps (ShadedScene::light_maps), so that no other maps
// need be made.
#include "reflection/picture.h"

#include <cstdint>

namespace kokage {

/// Per patch: 1 where the camera may see rough gloss on a smooth surface. None where shadows are not tested per pixel
/// (then gloss is in the patches' light), or where the picture has so many samples that rays tell more. The scene
/// needs no light yet.
std::vector<std::uint8_t> light_map_readers(const ShadedScene& scene, const Environment& environment,
                                            const Camera& camera, const PictureOptions& options);

} // namespace kokage
