#pragma once
// What every container of filtered light is to a baker: a list of texels, each a direction and a lobe.
#include "common/types.h"
#include "reflection/maps/lobe.h"

#include <vector>

namespace kokage {

/// Texels in the container's own order. A voxel cube has another parameter in almost every texel; a shell or a mip
/// level has one for all of its texels, which stand together.
struct TexelLayout {
    LobeKind kind = LobeKind::phong;
    std::vector<glm::vec3> directions; ///< unit: the axis of the lobe
    std::vector<float> parameters;     ///< Lobe::parameter of each texel
    std::size_t size() const { return directions.size(); }
};

} // namespace kokage
