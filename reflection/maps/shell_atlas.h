#pragma once
// All shells in one picture: what a GPU takes as one texture, and what an EXR file holds.
//
//        +-------------+--------+    A shell is a rectangle of 3 x 2 faces, each with its border (shell_map.h):
//        | smoothest   | next   |        +X  +Y  +Z          face f at column f / 2, row f % 2,
//        |             +---+----+        -X  -Y  -Z          u to the right, v downwards.
//        |             |   |    |    The rectangles stand on shelves, the largest first. Pixels between them are 0 and
//        +--------+----+-+-+----+    never read: places between texels stay half a texel inside of their face.
//        |        |      |      |
//        +--------+------+------+
//
// reflection/maps/shell_map.glsl reads the texture.
#include "common/scene/image.h"
#include "reflection/maps/shell_map.h"

#include <vector>

namespace kokage {

struct ShellAtlas {
    struct Place {
        int x = 0, y = 0; ///< pixel of the left upper corner of the shell's first face, border included
    };
    int width = 0, height = 0;
    std::vector<Place> places; ///< of each shell
};

/// Depends on the shells' sizes alone. `border` as ShellMap::border().
ShellAtlas shell_atlas(std::span<const ShellMap::Shell> shells, int border);

/// The map's texels in their places, RGB.
Image atlas_image(const ShellMap& map, const ShellAtlas& atlas);
/// The other way: what atlas_image gave, into a map with the same shells. Exact for values that its format holds.
void set_atlas_image(ShellMap& map, const ShellAtlas& atlas, const Image& image);

/// Uniform values of shell_map.glsl: of every shell x, y of its place, resolution, width.
std::vector<glm::vec4> shell_uniforms(const ShellMap& map, const ShellAtlas& atlas);

} // namespace kokage
