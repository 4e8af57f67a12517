#pragma once
// STL, binary or ASCII, by OpenMesh.
#include "common/scene/mesh_scene.h"

#include <filesystem>

namespace kokage {

/// One mesh without a material (SceneMaterial::is_missing). Vertices at the same place are joined; normals are made
/// anew, with creases where it turns by more than 40 degrees, because STL has only flat ones. Throws InputError with
/// one line that begins with the path: files that are cut off or are no STL, numbers that are not finite, more than
/// kMaximumSceneTriangles.
MeshScene read_stl_scene(const std::filesystem::path& path);

} // namespace kokage
