#pragma once
// Relief and shells as textures, for relief.glsl and surface_relief.glsl.
#include "reflection/relief/height_field.h"
#include "reflection/relief/relief_shell.h"
#include "reflection/relief/tangent_frames.h"

#include <array>
#include <cstdint>

namespace kokage {

/// Texels row by row; the last row may be filled up with zeros.
template <class Texel>
struct DataTexture {
    int width = 0, height = 0;
    std::vector<Texel> texels;

    std::size_t bytes() const { return texels.size() * sizeof(Texel); }
};

/// What relief.glsl reads. Depths stand at the corners of cells, the planes level by level, as in ExactTracer.
struct ReliefTextures {
    DataTexture<float> depths;                        ///< GL_R32F
    DataTexture<std::array<std::uint16_t, 4>> planes; ///< GL_RGBA16UI
    glm::ivec4 size{0};                               ///< uniform reliefSize
    std::array<glm::ivec2, 16> levels{};              ///< uniform reliefLevels
};
/// Throws InputError as ExactTracer does, and for more than 16384 texels on a side.
ReliefTextures make_relief_textures(const HeightField& field);

/// What surface_relief.glsl reads beside it.
struct SurfaceTextures {
    DataTexture<glm::vec4> places;  ///< GL_RGBA32F; two texels a place: outer, inner
    DataTexture<glm::vec4> frames;  ///< GL_RGBA32F; three texels a frame: along_u, along_v, normal
    DataTexture<glm::uvec4> prisms; ///< GL_RGBA32UI; five texels a prism, see surface_relief.glsl
};
/// Throws InputError for a mesh of more places or triangles than textures of 16384 x 16384 texels can hold.
/// The shader knows one relief: `layer`'s; triangles of other layers are solid to it.
SurfaceTextures make_surface_textures(const ReliefShell& shell, const TangentFrames& frames, int layer = 0);

} // namespace kokage
