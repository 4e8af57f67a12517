#pragma once
// Textures of leaves: where alpha cards are solid, and the colour.
#include "common/scene/image.h"
#include "trees/growth/parameters.h"

#include <memory>

namespace kokage {

/// Alpha of cards below this is a hole.
inline constexpr float mask_cutoff = 0.5f;

/// The alpha of cards, one channel: the finest outline, or the needles near one plane. Square, 128 texels wide for
/// blades, 256 for sprays; the same parameters give the same image, which is drawn once.
std::shared_ptr<const Image> leaf_mask(const GrowthParameters& parameters);

/// Share of the texels whose alpha is at least the cutoff.
double solid_share(const Image& mask, float cutoff);

/// The leaf's colour, linear, scaled so that its mean over the solid texels is `mean`: midrib and side veins paler;
/// between them what the season paints. 3 channels; drawn once, too.
std::shared_ptr<const Image> leaf_color(const GrowthParameters& parameters, const glm::vec3& mean);

} // namespace kokage
