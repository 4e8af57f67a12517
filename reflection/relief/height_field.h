#pragma once
// Relief over one tile of texture: how deep the surface lies below the polygon, the reference plane.
//
//      u ->                          Texture coordinates as glTF: (0, 0) is the upper left corner of the image, v grows
//    +---+---+---+---+               downwards. Texel (i, j) has its centre o at ((i + 0.5)/width, (j + 0.5)/height).
//  v | o | o | o | o |               Between four centres depth is bilinear: a CELL (i, j) has the centres of texels
//  | +---+---+---+---+               i, i+1 by j, j+1 as its corners; cells wrap around the tile, or repeat its border.
//  V | o | o | o | o |
//    +---+---+---+---+               Depth: 0 at the reference plane, 1 at the deepest that the scale allows.
//
// Seen from the side:   ---A------------------- depth 0: the polygon
//                            \  _      __
//                        __   \/ \____/  \__    a ray enters at A and hits the surface where its own depth reaches it
//                       /  \__/             \   .
//                       ----------------------- depth 1
#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

namespace kokage {

enum class HeightWrap {
    repeat, ///< the tile goes on for ever
    clamp,  ///< beyond the tile, the texels of its border go on for ever
};

/// Depths of all texels, finite and within [0, 1]; any size from 1 x 1 on, not square, not a power of two.
struct HeightField {
    int width = 0, height = 0;
    HeightWrap wrap = HeightWrap::repeat;
    std::vector<float> depths; ///< row by row from the top row

    float depth(int x, int y) const { return depths[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
    std::size_t bytes() const { return depths.size() * sizeof(float); }
};

/// What a tile measures on the surface that it covers.
struct ReliefScale {
    glm::vec2 tile_m{1.f}; ///< along u and v, metres, > 0
    float depth_m = 0.12f; ///< of depth 1, metres, >= 0; 0: flat
};

} // namespace kokage
