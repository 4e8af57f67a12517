#pragma once
// Branching of a foreign tree: from bark and leaf clusters. Private to trees.
#include "trees/tree.h"

namespace kokage {

/// Fills tree.skeleton, every leaf's branch and branching_known = false, and notes what was guessed. Needs parts
/// (foliage with its leaves; bark need not be cut into patches yet) and leaf centres. Where leaves hang far from all
/// wood (solid low-poly crowns, missing twigs), twigs of radius 0 are added that lead to clusters of leaves, so that
/// branching points stand where leaves are.
void infer_branching(Tree& tree);

/// Half the larger horizontal extent of the foliage; of all parts if there is no foliage.
float crown_radius(const Tree& tree);

} // namespace kokage
