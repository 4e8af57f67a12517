#pragma once
#include "common/services/progress.h"
#include "tests/benchmark/foliage_scenes.h"
#include "tests/benchmark/reference.h"

#include <filesystem>

namespace kokage {

struct ReferenceOptions {
    std::filesystem::path stored_folder; ///< references that came with the source; never written
    std::filesystem::path cache_folder;  ///< references that were made here, and sums of unfinished ones
    std::uint64_t paths_per_side = 1024; ///< of references that must be made
    std::uint64_t paths_per_chunk = 256; ///< a side, in each half: how much is lost when the work is stopped
};

/// A reference of this very scene, of at least paths_per_side: the stored one, or the one in the cache, or else it is
/// made (which may take long) and put in the cache. Files whose hash is not the scene's are never used. Work that was
/// stopped goes on where it was; a cached reference with fewer paths than asked is continued if its sums are there.
Reference find_or_make_reference(const BenchScene& scene, const ReferenceOptions& options, Progress& progress);

/// The stored or cached reference of this very scene, if there is one; makes none. With two, the less noisy one.
std::optional<Reference> find_reference(const BenchScene& scene, const ReferenceOptions& options);

/// File name of a scene's reference in either folder.
std::filesystem::path reference_file_name(const BenchSceneName& name);

} // namespace kokage
