#pragma once
// The scenes of the renderer's benchmark.
#include "viewer/scene/scene_description.h"

#include <string>
#include <vector>

namespace kokage {

/// "close" (an oak near the camera), "teapot" (a glossy teapot before a maple), "five" (five species on the ground),
/// all under the sky with its sun. `folder`: where the teapot stand-in is written if `data` (may be empty) holds none.
std::vector<SceneDescription> render_scenes(int width, int height, const std::filesystem::path& data,
                                            const std::filesystem::path& folder);

/// A pot as a solid of revolution with a knob, as an OBJ: for where the teapot is not to be had.
std::string turned_pot_obj();

} // namespace kokage
