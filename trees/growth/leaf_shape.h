#pragma once
// One leaf as a mesh, from which all leaves of a tree are made.
#include "trees/growth/parameters.h"
#include "trees/growth/spray.h"

#include <optional>
#include <vector>

namespace kokage {

/// What is counted and lit as one leaf: a broadleaf's blade with its petiole; of a conifer a spray, that is a piece of
/// twig with its needles (or its finest twigs clad in scales); of a cherry in blossom a cluster of flowers.
///
/// In units of the blade's (the spray's) length: the stalk's foot at the origin, the blade along +y, across it x, its
/// upper side towards +z.
struct LeafShape {
    std::vector<glm::vec3> positions, normals; ///< equally long; normals are unit vectors on the upper side
    std::vector<glm::vec2> uvs;                ///< u across (0..1), v along: 0 at the tip, 1 at the base
    std::vector<glm::uvec3> triangles;         ///< counter-clockwise seen from the upper side
    double area = 0;                           ///< of one side, holes of alpha textures taken out
};

/// Outlines: half_outline() mirrored, folded along the midrib by leaf_fold and bent along it by leaf_bend, so that the
/// tip is leaf_bend degrees lower than the base. Cards: flat; of a spray, its first half. Petioles longer than a tenth
/// of the blade are two triangles about 1.5 mm wide (an aspen's stands upright); shorter ones only hold the blade off
/// the shoot.
LeafShape leaf_shape(const GrowthParameters& parameters);

/// The spray that is one leaf of these parameters; empty for blades.
std::optional<Spray> leaf_spray(const GrowthParameters& parameters);

/// Mean area of a leaf in m^2, one side: lengths vary by leaf_length_spread. Of the tree in leaf, whatever the season:
/// the crown's size follows from it.
double mean_leaf_area(const GrowthParameters& parameters);

/// True if the tree blossoms: the season is blossom and it is a cherry. Other trees flower without show, and stand in
/// their spring leaf.
bool is_in_blossom(const GrowthParameters& parameters);
/// True if the tree stands without leaves: in winter, unless it is a conifer.
bool is_bare(const GrowthParameters& parameters);

} // namespace kokage
