#pragma once
// What was found in a tree, drawn: which leaves hang together, the wood by generation, and where light maps stand.
#include "common/scene/image.h"
#include "common/services/progress.h"
#include "trees/tree.h"

#include <string>
#include <vector>

namespace kokage {

/// How a generation is coloured: 0 is wood's grey-brown, then red, orange, ... (repeating).
const char* generation_color_name(int order);

struct BranchingPicture {
    Image image; ///< sRGB as 0..1 floats, ready for display; two panels of `panel` pixels square, side by side
    std::size_t maps = 0;
    std::vector<int> orders; ///< generations that occur, rising
    std::string note;        ///< of the placement of maps; may be empty
};

/// Left: bark grey, every leaf in the colour of the branch that it hangs on. Right: the branches that were found, as
/// tubes along their axes in their generation's colour (twigs that were only imagined are thin); the places of `maps`
/// light maps ([F] section 2) as balls in the colour of their generation, the border of each one's foliage cluster as a
/// ring that faces the camera. Throws Stopped.
BranchingPicture draw_branching(const Tree& tree, int maps, int panel, Progress& progress);

} // namespace kokage
