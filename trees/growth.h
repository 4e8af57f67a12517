#pragma once
// Growing a tree: parameters -> skeleton with numbered generations -> bark and leaves.
#include "common/services/progress.h"
#include "common/services/work_report.h"
#include "trees/growth/parameters.h"
#include "trees/species.h"
#include "trees/tree.h"

namespace kokage {

/// Grows a tree: trunk and limbs, then branches by space colonisation (Runions et al. 2007), shoots, leaves and bark.
/// It stands on y = 0 at the origin. The same parameters give the same bytes with any number of threads; leaves.size()
/// is exactly parameters.leaves. Leaf i is triangle patch i of the foliage part. Throws InputError if a parameter is
/// out of range. `report` (null = not wanted) gets the stages "skeleton", "bark" and "leaves".
Tree grow(const GrowthParameters& parameters, Progress& progress = silent_progress(), WorkReport* report = nullptr);

} // namespace kokage
