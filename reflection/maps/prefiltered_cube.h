#pragma once
// A cube map whose mip levels hold light filtered by ever wider lobes: what engines take (KTX2, DDS).
#include "reflection/maps/texel_layout.h"

#include <span>
#include <vector>

namespace kokage {

/// Faces +X, -X, +Y, -Y, +Z, -Z, each as OpenGL and KTX2 lay cube faces out (drawn here by who builds this). Level 0 is
/// `size` wide; level i has its own roughness.
struct PrefilteredCube {
    struct Level {
        int size = 0;
        double roughness = 0;          ///< glTF's; 0: the image itself, averaged over the texel
        std::vector<glm::vec3> texels; ///< 6 size², face by face, rows from the top
    };
    LobeKind kind = LobeKind::ggx;
    std::vector<Level> levels;
};

/// Unit direction of a texel's centre.
glm::dvec3 cube_texel_direction(int face, int x, int y, int size);

} // namespace kokage
