#pragma once
// Outlines of leaf blades, by species.
#include "common/types.h"

#include <string>
#include <vector>

namespace kokage {

/// Whose leaf it is. Broadleaves have a blade with an outline; pine, spruce and cypress have sprays (spray.h).
enum class LeafKind { oak, beech, birch, maple, willow, aspen, pine, spruce, cypress, cherry };

/// Names of the kinds, in their order.
const std::vector<std::string>& leaf_kind_names();
/// True for pine, spruce and cypress.
bool has_needles(LeafKind kind);

/// The right half of a blade in its own plane: x across (0..0.5), y along (0..1), from where the petiole meets the
/// blade (x = 0, its y is 0 or, between a maple's basal lobes, above 0) along the edge to the tip (0, 1). `y` up on the
/// page:
///
///          |\_            the tip, y = 1
///          |  )           lobes ...
///          | (            ... and the bays between them
///          |  )
///          |-'            the base
///
/// The polygon that this line and the midrib x = 0 enclose is simple, and it touches the midrib at its ends alone.
using HalfOutline = std::vector<glm::vec2>;

/// detail 0: one vertex between base and tip (a kite), 1: few, 2: lobes and teeth. Broadleaves only.
const HalfOutline& half_outline(LeafKind kind, int detail);
/// The finest outline: what alpha cards show.
const HalfOutline& mask_outline(LeafKind kind);

/// Area of the whole blade (both halves) in its own unit square: the share of length x width that it covers.
double outline_area(const HalfOutline& half);

/// Side veins, for textures: pairs of them along the midrib, and how steeply they rise (x across per y along); a
/// palmate leaf has none but those that fan out from the base.
struct Venation {
    int pairs = 6;
    float rise = 0.55f;
    bool is_palmate = false;
};
Venation venation(LeafKind kind);

} // namespace kokage
