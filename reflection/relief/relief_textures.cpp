#include "reflection/relief/relief_textures.h"
#include "common/services/error.h"
#include "reflection/relief/bound_planes.h"

#include <algorithm>
#include <bit>
#include <string>

namespace kokage {
namespace {

constexpr std::size_t kMostSide = 16384, kWidth = 4096;

/// As wide as kWidth, or one row.
template <class Texel>
DataTexture<Texel> rows_of(std::vector<Texel> texels, const char* what) {
    DataTexture<Texel> texture;
    const std::size_t width = std::clamp<std::size_t>(texels.size(), 1, kWidth);
    const std::size_t height = std::max<std::size_t>(1, (texels.size() + width - 1) / width);
    if (height > kMostSide)
        throw InputError("relief: " + std::to_string(texels.size()) + " " + what +
                         " are too many for a texture on the GPU: use a smaller map or a coarser mesh");
    texture.width = int(width);
    texture.height = int(height);
    texels.resize(width * height);
    texture.texels = std::move(texels);
    return texture;
}

} // namespace

ReliefTextures make_relief_textures(const HeightField& field) {
    BoundPlanes bounds = make_bound_planes(field);
    ReliefTextures textures;
    if (std::size_t(std::max(bounds.columns, bounds.rows)) >= kMostSide)
        throw InputError("relief: " + std::to_string(field.width) + " x " + std::to_string(field.height) +
                         " texels; a GPU takes 16382 on a side: make the map smaller");
    textures.depths = {bounds.columns + 1, bounds.rows + 1, std::move(bounds.depths)};
    std::vector<std::array<std::uint16_t, 4>> planes;
    for (const BoundPlane& p : bounds.planes)
        planes.push_back({std::uint16_t(p.slope_u), std::uint16_t(p.slope_v), p.middle, p.thickness});
    textures.planes = rows_of(std::move(planes), "planes");
    textures.size = {bounds.columns, bounds.rows, bounds.wrap == HeightWrap::repeat ? 1 : 0, int(bounds.levels.size())};
    for (std::size_t l = 0; l < bounds.levels.size(); ++l)
        textures.levels[l] = {int(bounds.levels[l].first), bounds.levels[l].columns};
    return textures;
}

SurfaceTextures make_surface_textures(const ReliefShell& shell, const TangentFrames& frames, int layer) {
    SurfaceTextures textures;
    std::vector<glm::vec4> places, frame_texels;
    for (std::size_t i = 0; i < shell.outer.size(); ++i) {
        places.emplace_back(shell.outer[i], 0);
        places.emplace_back(shell.inner[i], 0);
    }
    for (const TangentFrame& f : frames.frames)
        for (const glm::vec3& v : {f.along_u, f.along_v, f.normal})
            frame_texels.emplace_back(v, 0);
    std::vector<glm::uvec4> prisms;
    const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
    for (std::size_t t = 0; t < shell.prisms.size(); ++t) {
        const ReliefShell::Prism& p = shell.prisms[t];
        const bool odd = (p.corners[1] + 3 - p.corners[0]) % 3 != 1;
        const glm::vec2 tile = glm::floor(p.uvs[0]); // so that single precision has its digits for the rest
        const std::array uvs{p.uvs[0] - tile, p.uvs[1] - tile, p.uvs[2] - tile};
        prisms.emplace_back(p.places, (p.is_solid || int(p.layer) != layer ? 1u : 0u) | (odd ? 2u : 0u));
        prisms.emplace_back(p.neighbors[0], p.neighbors[1], p.neighbors[2], 0u);
        prisms.emplace_back(bits(uvs[0].x), bits(uvs[0].y), bits(uvs[1].x), bits(uvs[1].y));
        prisms.emplace_back(bits(uvs[2].x), bits(uvs[2].y), bits(tile.x), bits(tile.y));
        const glm::uvec3& corners = frames.corners[t];
        prisms.emplace_back(corners[p.corners[0]], corners[p.corners[1]], corners[p.corners[2]], 0u);
    }
    textures.places = rows_of(std::move(places), "texels of places");
    textures.frames = rows_of(std::move(frame_texels), "texels of tangent frames");
    textures.prisms = rows_of(std::move(prisms), "texels of prisms");
    return textures;
}

} // namespace kokage
