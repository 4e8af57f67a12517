#pragma once
// Wavefront OBJ with MTL, by tinyobjloader.
#include "common/scene/mesh_scene.h"
#include "common/services/progress.h"

#include <filesystem>

namespace kokage {

/// Reads an OBJ, its materials and their colour and alpha textures: a mesh for each object or group and material.
/// Polygons of any shape become triangles; negative indices count from the last vertex; missing normals are computed;
/// texture coordinates are turned to glTF's (v downwards).
///
/// - Kd is linear where the OBJ or its MTL says that Blender wrote it (Blender writes its linear values), else sRGB, as
///   three.js reads it: the format doesn't say, and other programs write what their colour pickers show. The notes say
///   which it was where it matters. It multiplies map_Kd; without Kd a textured surface is white.
/// - map_d, or the alpha of map_Kd where it cuts holes, is a mask at 0.5; `d` below 1 (or `Tr` above 0) is blending.
/// - Surfaces are double sided, as most OBJ exporters mean them.
/// - A material file or a colour texture that is not there is said in the notes (SceneMaterial::color_is_lost); a mask
///   that is not there is refused. A texture that is named by a path of another machine is looked for beside the file.
///
/// Not read: vertex colours, free-form surfaces, lines and points. Throws InputError with one line that begins with the
/// path: indices out of range, numbers that are not finite, sizes beyond the limits (lines of 64 KiB, polygons of 1024
/// corners, kMaximumSceneVertices).
MeshScene read_obj_scene(const std::filesystem::path& path, Progress& progress = silent_progress());

} // namespace kokage
