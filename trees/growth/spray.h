#pragma once
// Sprays: what hangs on a twig where the unit that is lit is not one blade: a piece of a conifer's twig with its
// needles or scales, or a cluster of cherry flowers.
#include "common/types.h"

#include <vector>

namespace kokage {

/// A straight, thin piece: a needle, a twig clad in scales, the spray's own axis, a petal.
struct SpraySegment {
    glm::vec3 base{0.f}, tip{0.f};
    glm::vec3 across{1, 0,
                     0}; ///< unit, at right angles to tip - base: its flat side looks along cross(across, tip - base)
    float half_width = 0;
    bool is_wood = false;  ///< the axis, or a flower's stalk
    bool is_petal = false; ///< widest in the middle; needles keep their width up to a short point
};

/// In the frame of a leaf, in units of the spray's length: the axis runs from the origin along +y to y = 1 at most,
/// everything lies within |x|, |z| <= width / 2. Segments lie near two planes, x-y and z-y, one half each (the
/// second half is the first turned by 90 degrees about y), so that a card shows one of them.
struct Spray {
    std::vector<SpraySegment> segments; ///< in units of the spray's length, after scaling x and z by `width`
    std::size_t first_half = 0;         ///< so many segments, from the first, are those near the plane x-y
};

/// Scots pine: pairs of needles (fascicles) that stand out from the outer part of the shoot and lean forwards.
/// `needles` is their number; the spray's width is `width` of its length.
Spray pine_spray(int needles, float width);
/// Norway spruce: single needles all around the twig, longest in the middle.
Spray spruce_spray(int needles, float width);
/// Cypress: twigs clad in scale leaves that fork alternately; `twigs` is the number of the finest ones.
Spray cypress_spray(int twigs, float width);
/// Japanese cherry: a corymb of four flowers with five petals each.
Spray cherry_blossom(float width);

/// Length of a pine's or spruce's longest needle, of the spray's length.
float longest_needle(const Spray& spray);

} // namespace kokage
