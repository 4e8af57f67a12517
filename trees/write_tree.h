#pragma once
// Trees to binary glTF, plain or shaded, and shaded ones back.
#include "common/scene/light_map.h"
#include "common/services/progress.h"
#include "trees/tree.h"

#include <filesystem>

namespace kokage {

/// Solved light of a tree, one entry a patch: the tree's leaves in order, then its bark patches in order.
struct ShadedAttributes {
    std::vector<glm::vec3> radiance_front, radiance_back; ///< linear, unscaled; of bark, only the front is written
    std::vector<glm::vec3> indirect_front, indirect_back; ///< without the split-off lights; both may be empty
    std::vector<LightMap> light_maps;                     ///< may be empty
    /// COLOR_0 = mean of both sides / mean base colour / scale, clamped to [0,1]. 0 when writing: the 99th percentile
    /// of that over leaves, bark patches and channels. After reading: the file's.
    float scale = 0;
};

struct WriteOptions {
    /// Leaves as two single-sided sheets, for viewers that need both: COLOR_0 is then each side's own.
    bool split_sides = false;
};

/// Writes a .glb, whole or not at all. Unshaded (`shaded` null): materials as they are. Shaded: float32 attributes
/// `_RADIANCE_FRONT`, `_RADIANCE_BACK`, `_INDIRECT_FRONT`, `_INDIRECT_BACK` on leaves, `_RADIANCE`, `_INDIRECT` on
/// bark, COLOR_0 as above, KHR_materials_unlit. `extras.kokage` keeps what a mesh can't: skeleton with generations,
/// which branch bears which leaf, leaf and patch numbers, light maps, the scale; large arrays are accessors that it
/// names. read_tree() gives back the same bits. Throws InputError for a file that can't be written, sizes that don't
/// fit the tree, and numbers that are not finite.
void write_tree(const std::filesystem::path& path, const Tree& tree, const ShadedAttributes* shaded = nullptr,
                const WriteOptions& options = {}, Progress& progress = silent_progress());

/// The light of a file that write_tree() wrote shaded, per patch; the back of bark, which is not kept, reads 0.
/// Throws InputError if the file is not one.
ShadedAttributes read_shaded(const std::filesystem::path& path, Progress& progress = silent_progress());

} // namespace kokage
