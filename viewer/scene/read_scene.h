#pragma once
// A scene file (JSON) or "just a tree" -> SceneDescription.
#include "viewer/scene/scene_description.h"

namespace kokage {

/// Files are looked for beside the scene file, then in the folder `data` (data_folder.h). Throws InputError, one line
/// with the file, the JSON pointer, what was found and what is allowed: for syntax, unknown or doubled keys (the
/// nearest known one is told), wrong types, values out of range, missing files, materials that no one declared.
SceneDescription read_scene(const std::filesystem::path& file, const std::filesystem::path& data = {});

/// The scene of a single tree where nothing else is said.
SceneDescription scene_of_tree(const TreeSource& tree);

} // namespace kokage
