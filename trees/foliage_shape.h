#pragma once
// Foliage told by its shape alone: many small flat pieces. Private to trees.
#include "common/scene/mesh_scene.h"

#include <vector>

namespace kokage {

struct LoosePieces {
    std::vector<bool> triangles; ///< for each triangle of the mesh, whether it belongs to a small flat piece
    std::size_t count = 0;       ///< of such pieces
    double share = 0;            ///< of the mesh's area, 0..1
};

/// The connected pieces of a mesh that are flat (most of their area faces one way or its opposite) and no longer than
/// `longest`, in the mesh's units.
LoosePieces small_flat_pieces(const SceneMesh& mesh, double longest);

/// Diagonal of the box around all meshes of a scene.
double diagonal_of(const MeshScene& scene);

} // namespace kokage
