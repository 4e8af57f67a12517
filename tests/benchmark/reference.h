#pragma once
// Converged radiance of leaf sides, by path tracing alone: what every other figure is measured against.
#include "common/types.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace kokage {

struct Reference {
    std::uint64_t scene_hash = 0; ///< of the scene that it was made for
    std::uint64_t paths_per_side = 0;
    double noise = 0;             ///< its own MRE, from its two independent halves
    std::vector<glm::vec3> sides; ///< as leaf_side_radiance(): front and back of leaf 0, of leaf 1, ...
};

/// A reference file: a line of text that names the format, a line of JSON (hash, paths, noise, sides), then 16-bit
/// codes (radiance_code.h), little-endian, red of all sides, then green, then blue. Written whole or not at all. Throws
/// InputError if it can't be written.
void save_reference(const std::filesystem::path& path, const Reference& reference);

/// Empty if there is no such file. Throws InputError if there is one that can't be understood.
std::optional<Reference> load_reference(const std::filesystem::path& path);

/// Sums of path-traced radiance in two halves, which go on from where they were after the work was stopped.
struct ReferenceSums {
    std::uint64_t scene_hash = 0;
    std::uint64_t paths_per_chunk = 0; ///< a side, in each half
    std::uint64_t chunks = 0;          ///< finished, in each half
    std::vector<glm::dvec3> half[2];   ///< sums over chunks of a chunk's mean radiance

    /// Mean of both halves and the noise that their difference shows. At least one chunk.
    Reference reference() const;
};

void save_sums(const std::filesystem::path& path, const ReferenceSums& sums);
/// Empty if there is no such file, it is of another scene or chunk size, or it is damaged: it is then begun anew.
std::optional<ReferenceSums> load_sums(const std::filesystem::path& path, std::uint64_t scene_hash,
                                       std::uint64_t paths_per_chunk);

} // namespace kokage
