#include "foliage/bundles/ray_link_tracing.h"

#include "common/services/parallel.h"
#include "foliage/cosine_direction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace kokage::bundles {
namespace {

constexpr std::size_t kPatchesAtOnce = 8192; ///< bounds the memory of rays under way
constexpr std::size_t kTracedBlock = 16;
constexpr int kSkyCells = 2 * 32 * 32;      ///< 6 degrees a cell: the sky without its lights is smooth
constexpr std::uint32_t kEnd = 0x80000000u; ///< marks a ray that met no patch; the other bits hold its entry of `ends`

/// Sides that rays met, row by row as in RayLinks.
struct Met {
    std::vector<std::uint32_t> begin{0};
    std::vector<Side> sides;
};

/// Of a patch's four rows, as in RayLinks.
using RowLengths = std::array<std::uint32_t, 4>;

/// What the rays of one patch saw: four rows, each with room for so many rays.
struct SeenRows {
    std::uint32_t* codes;
    std::size_t room;
    std::uint32_t* row(std::size_t k) const { return codes + k * room; }
};

class RayTracing {
  public:
    RayTracing(const RayQueries& queries, const PatchPoints& points, const Facets& facets,
               const std::optional<GroundGrid>& ground, const RayLinks& rays, std::uint64_t seed)
        : queries_(queries), points_(points), facets_(facets), ground_(ground), rays_(rays), seed_(seed) {}

    /// Fills the four rows of a patch, of rays[row] rays, from ray `first` on with sides, or kEnd + entry. False if no
    /// solid point was found.
    bool look_around(std::uint32_t patch, const RowLengths& rays, std::uint32_t first, SeenRows seen) const {
        for (std::uint32_t row = 0; row < 4; ++row)
            for (std::uint32_t i = first; i < rays[row]; ++i) {
                PathNumbers numbers(hash64(seed_ ^ hash64(4 * std::uint64_t(patch) + row)), i);
                PatchPoint point;
                if (!points_.sample(patch, numbers, point))
                    return false;
                const glm::vec3 direction = cosine_direction(row < 2 ? point.normal : -point.normal, numbers.pair());
                seen.row(row)[i] = look(point.position, direction);
            }
        return true;
    }

  private:
    std::uint32_t look(const glm::vec3& from, const glm::vec3& direction) const {
        const PatchScene& scene = queries_.scene();
        RayHit hit;
        const bool met =
            queries_.first_hit(from, direction, queries_.ray_offset(), std::numeric_limits<float>::infinity(), hit);
        if (met && !hit.ground)
            return 2 * scene.triangle_patch[hit.triangle] + (glm::dot(hit.geometric_normal, direction) > 0);
        if (!ground_ || direction.y >= 0)
            return kEnd + std::uint32_t(rays_.sky_cells.cell(direction));
        return kEnd + std::uint32_t(rays_.sky_cells.size()) +
               (met ? texel_under(from + hit.distance * direction) : ground_->texels());
    }

    std::uint32_t texel_under(const glm::vec3& point) const {
        const glm::vec3 scaled((glm::dvec3(point) - facets_.centre) * facets_.scale);
        const int texel = ground_->texel_at(scaled.x, scaled.z);
        return texel >= 0 ? std::uint32_t(texel) : ground_->texels();
    }

    const RayQueries& queries_;
    const PatchPoints& points_;
    const Facets& facets_;
    const std::optional<GroundGrid>& ground_;
    const RayLinks& rays_;
    std::uint64_t seed_;
};

/// An end of an earlier ray, whose ground may have had larger texels.
std::uint32_t end_now(std::uint16_t end, const BundleTransport& earlier, const std::optional<GroundGrid>& ground) {
    const std::size_t sky = earlier.rays.sky_cells.size();
    if (end < sky || !ground || !earlier.ground || ground->size == earlier.ground->size)
        return kEnd + end;
    const auto texel = std::uint32_t(end - sky);
    int now = -1;
    if (texel < earlier.ground->texels()) {
        const glm::vec2 centre = earlier.ground->centre_of(texel);
        now = ground->texel_at(centre.x, centre.y);
    }
    return kEnd + std::uint32_t(sky) + (now >= 0 ? std::uint32_t(now) : ground->texels());
}

/// Copies what earlier rays of a patch saw to the start of its rows; returns their number, 0 if there are none.
std::uint32_t recall(std::uint32_t patch, const BundleTransport& earlier, const std::optional<GroundGrid>& ground,
                     const RowLengths& lengths, SeenRows seen) {
    const RayLinks& rays = earlier.rays;
    const auto found = std::lower_bound(rays.patches.begin(), rays.patches.end(), patch);
    const std::size_t first = 4 * std::size_t(found - rays.patches.begin());
    if (found == rays.patches.end() || *found != patch || rays.rays_of(first) > lengths[0])
        return 0;
    for (std::uint32_t row = 0; row < 4; ++row) {
        const Side side = 2 * patch + row / 2;
        const std::span<const std::uint16_t> ends = rays.ends_of(first + row);
        const std::size_t met = rays.rays_of(first + row) - ends.size();
        const std::span<const Side> lines = earlier.links.row(side);
        const auto from =
            row % 2 == 0 ? lines.begin() : lines.begin() + std::ptrdiff_t(earlier.links.half_row(side, 0).size());
        const auto to = std::copy_n(from, met, seen.row(row));
        std::transform(ends.begin(), ends.end(), to, [&](std::uint16_t end) { return end_now(end, earlier, ground); });
    }
    return rays.rays_of(first);
}

/// Sorts what the rays of one patch saw into rows of sides and rows of ends.
void append(std::uint32_t patch, const RowLengths& lengths, SeenRows seen, RayLinks& rays, Met& met) {
    rays.patches.push_back(patch);
    for (std::uint32_t row = 0; row < 4; ++row) {
        for (std::uint32_t code : std::span(seen.row(row), lengths[row]))
            if (code & kEnd)
                rays.ends.push_back(std::uint16_t(code & ~kEnd));
            else
                met.sides.push_back(code);
        rays.end_begin.push_back(std::uint32_t(rays.ends.size()));
        met.begin.push_back(std::uint32_t(met.sides.size()));
    }
}

/// Compressed rows with those of the traced patches replaced. A row in which no ray met anything keeps one neighbour
/// of what lines found: rows may not be empty, and its closed share is 0.
void replace_rows(const RayLinks& rays, const Met& met, Links& links) {
    const std::size_t sides = links.side_count();
    Links old;
    std::swap(old, links);
    links.ground = std::move(old.ground);
    links.ground_begin = std::move(old.ground_begin);
    links.ground_pixel_area = std::move(old.ground_pixel_area);
    const auto met_by = [&](std::size_t row) {
        return std::span(met.sides).subspan(met.begin[row], met.begin[row + 1] - met.begin[row]);
    };
    /// Calls store(side, first half, second half) for all rows.
    const auto for_each_row = [&](auto&& store) {
        std::size_t next = 0; // of rays.patches
        for (Side side = 0; side < sides; ++side) {
            while (next < rays.patches.size() && rays.patches[next] < side / 2)
                ++next;
            const bool traced = next < rays.patches.size() && rays.patches[next] == side / 2;
            const std::size_t row = 4 * next + 2 * (side % 2);
            if (traced && met.begin[row] < met.begin[row + 2]) {
                store(side, met_by(row), met_by(row + 1));
            } else {
                std::span<const Side> halves[2] = {old.half_row(side, 0), old.half_row(side, 1)};
                if (traced) {
                    const bool in_first = !halves[0].empty();
                    halves[!in_first] = halves[!in_first].first(1);
                    halves[in_first] = {};
                }
                store(side, halves[0], halves[1]);
            }
        }
    };
    std::vector<std::uint32_t> lengths[2] = {std::vector<std::uint32_t>(sides), std::vector<std::uint32_t>(sides)};
    for_each_row([&](Side side, std::span<const Side> first, std::span<const Side> second) {
        lengths[0][side] = std::uint32_t(first.size());
        lengths[1][side] = std::uint32_t(second.size());
    });
    links.lay_out(lengths[0], lengths[1]);
    for_each_row([&](Side side, std::span<const Side> first, std::span<const Side> second) {
        const std::size_t place = links.place(side);
        std::copy(first.begin(), first.end(), links.neighbours.begin() + links.begin[place]);
        std::copy(second.begin(), second.end(), links.neighbours.begin() + links.middle[place]);
    });
}

} // namespace

std::vector<std::uint32_t> leaves_too_small_for_lines(const PatchScene& scene, const Facets& facets,
                                                      const BundleSettings& settings) {
    constexpr double kFarBelow = 1.0 / 16, kFewLines = 8, kBelow = 1.0 / 4;
    // A leaf's mean projected area is half its area; one of mean area gets `wanted`.
    const double density = pixel_density(facets, settings.link_pixels),
                 lines_per_area = settings.link_directions * density * density / 2,
                 wanted = double(settings.link_directions) * double(settings.link_pixels);
    std::vector<std::uint32_t> small;
    for (std::size_t p = 0; p < scene.patches.size(); ++p) {
        const double lines = lines_per_area * double(facets.patch_area[p]);
        if (scene.patches[p].kind == PatchKind::leaf && lines > 0 &&
            (lines < kFarBelow * wanted || (lines < kFewLines && lines < kBelow * wanted)))
            small.push_back(std::uint32_t(p));
    }
    return small;
}

std::uint32_t rays_a_side(const BundleSettings& settings) {
    // As many as directions: a leaf of mean size gets three times as many lines, but those of one direction are alike.
    const int directions = settings.sky_directions + settings.link_directions;
    return 2 * std::uint32_t(std::clamp((directions + 1) / 2, 8, 4096));
}

void add_ray_links(const RayQueries& queries, const PatchPoints& points, const Facets& facets,
                   const std::vector<std::uint32_t>& small, std::uint32_t rays_a_side, std::uint64_t seed,
                   const BundleTransport& earlier, BundleTransport& transport, Progress& progress) {
    RayLinks& rays = transport.rays;
    rays = {};
    std::vector<std::uint32_t> patches = small; // leaves come before all others
    patches.insert(patches.end(), facets.wide_patches.begin(), facets.wide_patches.end());
    if (patches.empty())
        return;
    rays.rays_a_row = std::max(1u, rays_a_side / 2);
    rays.sky_cells = make_capture_directions(1, kSkyCells);
    rays.end_begin.push_back(0);
    const RayTracing tracing(queries, points, facets, transport.ground, rays, seed);
    Met met;
    std::vector<std::uint32_t> seen;
    std::vector<std::uint8_t> solid;
    progress.begin("tracing rays", patches.size());
    /// Of patches [first, last), which are all small or all wide.
    const auto trace = [&](std::size_t first, std::size_t last, const RowLengths& lengths) {
        const std::size_t count = last - first, room = lengths[0];
        seen.resize(4 * count * room);
        solid.resize(count);
        const auto rows_of = [&](std::size_t i) { return SeenRows{seen.data() + 4 * i * room, room}; };
        parallel_blocks(count, kTracedBlock, [&](std::size_t from, std::size_t to) {
            progress.throw_if_stopped();
            for (std::size_t i = from; i < to; ++i) {
                const std::uint32_t patch = patches[first + i];
                const std::uint32_t known = recall(patch, earlier, transport.ground, lengths, rows_of(i));
                solid[i] = tracing.look_around(patch, lengths, known, rows_of(i));
            }
            progress.advance(to - from);
        });
        for (std::size_t i = 0; i < count; ++i)
            if (solid[i])
                append(patches[first + i], lengths, rows_of(i), rays, met);
    };
    const std::uint32_t of_small = rays.rays_a_row, of_wide = RayLinks::kRaysOfWide * of_small;
    for (std::size_t first = 0; first < small.size(); first += kPatchesAtOnce)
        trace(first, std::min(first + kPatchesAtOnce, small.size()), {of_small, of_small, of_small, of_small});
    rays.small_count = rays.patches.size();
    for (std::size_t first = small.size(); first < patches.size(); first += kPatchesAtOnce)
        trace(first, std::min(first + kPatchesAtOnce, patches.size()), {of_wide, of_wide, 0, 0});
    replace_rows(rays, met, transport.links);
}

} // namespace kokage::bundles
