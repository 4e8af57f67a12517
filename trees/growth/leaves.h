#pragma once
// Leaves on shoots.
#include "trees/growth/skeleton.h"

namespace kokage {

/// A leaf blade in its own plane: x across (-0.5..0.5), y along (0..1), stalk at the origin. `y` up on the page:
///
///          _( )_        the tip, y = 1
///         (     )       lobes ...
///          )   (        ... and the bays between them
///         (     )
///          '-.-'        the base, y = 0
struct LeafShape {
    std::vector<glm::vec2> outline;    ///< vertices: the outline's, and the midrib's in the finest shape
    std::vector<glm::uvec3> triangles; ///< counter-clockwise; none crosses the midrib x = 0
};

/// detail 0: a kite (2 triangles), 1: lobed (8), 2: round lobes (44).
const LeafShape& leaf_shape(int detail);
/// Area of the shape in its own unit square.
double leaf_shape_area(int detail);
/// Area of the outline that alpha cards show, in the same unit square.
double leaf_mask_area();
/// True inside the outline that alpha cards show, which the finest shape follows; uv as on the leaf: u across, v from
/// the tip (0) to the base (1).
bool inside_leaf_shape(glm::vec2 uv);

/// All leaves as one foliage part (with uvs: u across, v = 0 at the tip), and their centres.
void make_leaves(const GrownSkeleton& skeleton, const GrowthParameters& parameters, const glm::vec3& crown_centre,
                 TreePart& part, std::vector<Leaf>& leaves);

} // namespace kokage
