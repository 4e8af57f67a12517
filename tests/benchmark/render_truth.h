#pragma once
// The truth of a picture, on pixels here and there, by path tracing.
#include "viewer/scene/render_scene.h"

#include <filesystem>
#include <string>
#include <vector>

namespace kokage {

struct PictureTruth {
    std::vector<std::uint32_t> pixels;      ///< judged: y width + x; those that were traced and show anything near
    std::vector<std::uint8_t> kind;         ///< of each of them, number in pixel_kinds()
    std::vector<glm::vec3> radiance;        ///< of each of them: mean of two independent halves
    std::vector<glm::vec3> half_difference; ///< half of what the halves differ: it spreads as `radiance` does
    double mean = 0;                        ///< of radiance over the judged pixels and channels
    double noise = 0;                       ///< mean of |half_difference| over `mean`
    std::uint64_t samples = 0;              ///< paths a pixel
    bool is_stored = false;                 ///< not traced in this run
};

/// leaf, bark, object, ground, edge (more than one of them, or sky), by rays through a pixel's middle and corners.
const std::vector<std::string>& pixel_kinds();

struct TruthOptions {
    std::filesystem::path stored_folder; ///< truths that came with the source; never written
    std::filesystem::path cache_folder;  ///< truths that were traced here, and sums of unfinished ones
    std::uint64_t samples = 8192;        ///< paths a pixel of truths that must be traced
};

/// Of the pixels that `picture` says are traced: the stored truth of this very scene and picture (picture_hash), or the
/// one in the cache, whichever has more samples, or else it is traced and put in the cache. Work that was stopped goes
/// on where it was.
PictureTruth find_truth(const AssembledScene& scene, const PictureOptions& picture, const std::string& name,
                        const TruthOptions& options, Progress& progress);

/// File name of a truth in either folder: "picture-close-480x360.reference".
std::string truth_file_name(const std::string& name, const PictureOptions& picture);

} // namespace kokage
