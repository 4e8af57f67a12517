#pragma once
// Which patches are flat. Private to reflection.
#include "common/scene/patch_scene.h"

#include <cstdint>
#include <vector>

namespace kokage {

/// 1 for patches all but a hundredth of whose area faces one way, within 20 degrees: leaves are usually folded or
/// curled by 12 to 16, which changes what rough ones mirror by less than single rays do. Rounded patches, and leaves of
/// crossed cards, are none.
std::vector<std::uint8_t> flat_patches(const PatchScene& scene);

} // namespace kokage
