#pragma once
#include "common/scene/image.h"
#include "common/types.h"

#include <memory>

namespace kokage {

enum class TextureWrap { repeat, mirror, clamp };

/// Where a surface is solid and where light passes: alpha of a texture against a cutoff (glTF alphaMode MASK).
/// The one definition of "is there leaf here?" for rasters, rays and pictures alike: the NEAREST texel's alpha >=
/// cutoff, so that every method sees exactly the same holes.
struct AlphaMask {
    std::shared_ptr<const Image> alpha; ///< one channel
    float cutoff = 0.5f;
    TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;

    /// True where the surface is solid. uv as in glTF (origin at the top left of the image), any finite value.
    bool solid(glm::vec2 uv) const;
};

} // namespace kokage
