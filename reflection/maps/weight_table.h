#pragma once
// [R] section 6: which vertices of which geodesic dome a texel sums, and with which weights. Light plays no part in it:
// it is made once and used for every frame.
#include "common/services/progress.h"
#include "common/services/work_report.h"
#include "reflection/maps/dome_pyramid.h"
#include "reflection/maps/texel_layout.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace kokage {

enum class TableWeights {
    /// As `renormalised`, then tilted: each times exp(b . direction), with b such that the row's mean direction is the
    /// lobe's own, less the blur of the pyramid. So light that is linear in direction comes out right, whatever was cut
    /// off and
    /// wherever the vertices lie (but for how the blur differs from its mean over all latitudes). (No weight is raised
    /// above even ones: of GGX's tails what is cut stays
    /// cut.)
    matched,
    /// Weights times the area that a vertex stands for, kept where the lobe exceeds threshold x its peak, and
    /// normalised
    /// over what is kept: a constant image stays itself.
    renormalised,
    /// As the paper's figures imply: eq 9 over all vertices of the hemisphere, each counting the same, then those
    /// left out where the lobe is not above 3 x threshold x its peak, and not normalised again: about 3 x threshold of
    /// the light is lost.
    paper,
};

/// "matched", "renormalised", "paper"; throws InputError that lists them.
TableWeights table_weights_from_name(std::string_view name);

struct TableSettings {
    double threshold = 0.001; ///< th of eq 14, of the lobe's peak; in (0, 0.3)
    TableWeights weights = TableWeights::matched;
    /// A texel sums the coarsest dome that has at least so many vertices in the solid angle 1/peak of its lobe. About 5
    /// makes the paper's cube change domes at smoothness 1/2, 1/4, 1/8 and gives its sizes of table.
    double vertices_a_lobe = 5;
    std::uint64_t most_bytes = std::uint64_t(2) << 30; ///< refused beyond
};

/// Texels that lie symmetrically share a row: cubes and domes both keep their shape under the 24 symmetries of
/// dome_pyramid.h, so a row serves up to 24 texels, each with the dome's vertices permuted. Directions count as
/// symmetric, and parameters as the same, where they agree to 2^-20.
///
/// Memory: 6 bytes an entry (16 bits which vertex, a float weight), 4 a texel, 16 a row.
class WeightTable {
  public:
    /// Throws InputError for settings out of range and where the table would take more than most_bytes (known before
    /// memory is taken), Stopped.
    WeightTable(const TexelLayout& layout, const TableSettings& settings, Progress& progress = silent_progress());

    /// Reads one that was stored for the same layout and settings. Throws InputError that names the file and says what
    /// is wrong: no weight table, another version, truncated, altered, made for other texels or settings.
    static WeightTable load(const std::filesystem::path& path, const TexelLayout& layout,
                            const TableSettings& settings);
    void save(const std::filesystem::path& path) const;

    /// One value a texel, in the layout's order. `light` holds the radiance of every vertex of every dome.
    void filter(const DomeLight& light, std::span<glm::vec3> filtered, Progress& progress = silent_progress()) const;

    std::uint64_t texels() const { return members_.size(); }
    std::uint64_t rows() const { return levels_.size(); }
    std::uint64_t entries() const { return weights_.size(); } ///< stored
    std::uint64_t weights() const { return unshared_; }       ///< that a table without sharing would store
    std::uint64_t bytes() const;                              ///< in memory, and in a file but for its header
    /// Without sharing, as the paper stores it: 6 bytes an entry and a row's start (4 bytes) a texel.
    std::uint64_t unshared_bytes() const { return 6 * unshared_ + 4 * texels(); }

  private:
    WeightTable() = default;
    void find_members(const TexelLayout& layout, std::vector<std::uint32_t>& texel_of_row);
    void fill_rows(const TexelLayout& layout, const TableSettings& settings,
                   const std::vector<std::uint32_t>& texel_of_row, Progress& progress);
    void use_slots();
    bool is_consistent() const;

    /// Rows are CSR: entries starts_[row] .. starts_[row + 1], members member_starts_[row] .. of [row + 1].
    std::vector<std::uint64_t> starts_;
    std::vector<std::uint32_t> member_starts_;
    std::vector<std::uint8_t> levels_;             ///< which dome a row sums
    std::vector<std::uint32_t> members_;           ///< texel * 32 + symmetry
    std::vector<std::uint16_t> slots_;             ///< of used_[level]
    std::vector<float> weights_;                   ///< beside slots_
    std::vector<std::uint16_t> used_[kDomeLevels]; ///< vertices that some row sums, ascending
    std::uint64_t unshared_ = 0;
    std::uint64_t identity_ = 0; ///< hash of layout and settings
};

/// Of layout and settings: tables of the same identity are the same.
std::uint64_t table_identity(const TexelLayout& layout, const TableSettings& settings);

} // namespace kokage
