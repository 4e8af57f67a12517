#pragma once
// Bark as images: colour and height of a piece that repeats without a seam.
#include "common/scene/image.h"
#include "common/types.h"
#include "trees/growth/bark_kind.h"

namespace kokage {

/// One tile of bark. x runs around the stem, y along it; both wrap. A tile on a trunk is `bark_tile` metres wide and
/// high (a growth parameter).
struct BarkImage {
    Image color;         ///< linear Rec.709, 3 channels, 0..1: the diffuse albedo
    Image height;        ///< 1 channel, 0 (the bottom of the deepest fissure) .. 1
    float depth_m = 0;   ///< how much higher 1 is than 0
    float roughness = 1; ///< as in glTF's metallic-roughness
};

/// Draws it, size x size texels. `age` goes from 0, the bark of limbs and young stems, to 1, that at the foot of an old
/// trunk: a birch turns from white with lenticels to black and fissured, a pine from orange flakes to brown plates, an
/// aspen from green with diamonds to dark and furrowed; the others' fissures deepen. The same arguments give the same
/// image with any number of threads. Throws std::invalid_argument unless 1 <= size <= 8192 and 0 <= age <= 1.
BarkImage bark_image(BarkKind kind, float age, int size = 256);

/// Birch, aspen and pine turn into something else as they age: young bark gives way to old, patch by patch, and both
/// keep their colours. Of the others all bark darkens a little.
bool turns_with_age(BarkKind kind);

/// Colour of twigs in their first years.
glm::vec3 young_twig_color(BarkKind kind);

float bark_roughness(BarkKind kind);
/// Mean colour of that image, which is scaled to it.
glm::vec3 mean_bark_color(BarkKind kind, float age);

} // namespace kokage
