#pragma once
// A glTF file's default scene, flattened.
#include "common/gltf/gltf_document.h"
#include "common/scene/mesh_scene.h"

namespace kokage {

/// Flattens the default scene (else the first with meshes, else all root nodes): morph targets with their default
/// weights, skins in the pose that the nodes have, instances (EXT_mesh_gpu_instancing). Transforms are multiplied in
/// double precision. `origin`: taken as it is where given; else 0 unless the scene lies farther from it than 16 times
/// its size. Throws InputError for indices out of range, numbers that are not finite, node cycles, more vertices than
/// the limit, images that can't be had where they hold an alpha mask, and images that are damaged.
MeshScene flatten(const GltfDocument& document, std::optional<glm::dvec3> origin = std::nullopt,
                  Progress& progress = silent_progress());

/// Reads what flatten() leaves out: SceneMaterial::roughness_metallic_texture of the scene's materials. One in a format
/// that can't be decoded is noted.
void read_gltf_gloss_textures(const GltfDocument& document, MeshScene& scene, Progress& progress = silent_progress());
/// And SceneMaterial::normal_texture, of opaque materials: leaves show none.
void read_gltf_normal_textures(const GltfDocument& document, MeshScene& scene, Progress& progress = silent_progress());

} // namespace kokage
