#include "foliage/ground_in_view.h"

#include "common/services/parallel.h"
#include "foliage/patch_geometry.h"

#include <algorithm>
#include <cmath>

namespace kokage {

namespace {

using namespace bundles;

constexpr std::size_t kBlockInView = 4096;

struct Seen {
    std::uint16_t cell;
    float weight;
};

/// Of one block of patches, side by side.
struct Rows {
    std::vector<std::uint32_t> lengths;
    std::vector<Seen> seen;
};

class GroundSearch {
  public:
    GroundSearch(const PatchScene& scene, const GroundCells& ground, const Facets& facets,
                 const BundleTransport& transport)
        : ground_(ground), facets_(facets), transport_(transport), centres_(patch_geometry(scene).centres) {}

    /// What the far ends of lines show to both sides of a patch. `all`: as if nothing stood in the way.
    void by_lines(std::uint32_t patch, bool all, std::vector<Seen> (&sides)[2]) const {
        for (std::uint32_t f = facets_.patch_first_facet[patch]; f < facets_.patch_first_facet[patch + 1]; ++f) {
            by_lines(facets_.facets[f], f, transport_.sky_lines, transport_.sky_open, all, sides);
            by_lines(facets_.facets[f], f, transport_.link_lines, transport_.link_open, all, sides);
        }
    }

    void by_rays(std::size_t ray_patch, std::vector<Seen> (&sides)[2]) const {
        const RayLinks& rays = transport_.rays;
        for (std::size_t row = 0; row < 4; ++row)
            for (std::uint16_t end : rays.ends_of(4 * ray_patch + row))
                if (end >= rays.sky_cells.size())
                    sides[row / 2].push_back({cell_of_texel(end - rays.sky_cells.size()), 1.f});
    }

  private:
    void by_lines(const Facet& facet, std::uint32_t f, const LineDirections& lines, const OpenFractions& open, bool all,
                  std::vector<Seen> (&sides)[2]) const {
        const std::uint8_t* shares = open.far_end.data() + f;
        for (const glm::vec3& direction : lines.directions) {
            const std::uint8_t share = all ? std::uint8_t(254) : *shares;
            shares += open.facet_count;
            if (share == 0 || share == OpenFractions::kUnseen)
                continue;
            const float facing = glm::dot(facet.normal, direction); // the front is far where it is not negative
            const float projected = facet.bark ? facet.projected_share(direction) : std::abs(facing);
            sides[!facet.bark && facing < 0].push_back(
                {cell_along(centres_[facet.patch], direction), facet.area * projected * float(share)});
        }
    }

    std::uint16_t cell_along(const glm::vec3& from, const glm::vec3& direction) const {
        const float distance = (ground_.height_m - from.y) / direction.y; // far or not finite: the far cell
        return std::uint16_t(ground_.cell(from + distance * direction));
    }

    std::uint16_t cell_of_texel(std::size_t texel) const {
        const GroundGrid& grid = *transport_.ground;
        if (texel >= grid.texels())
            return std::uint16_t(ground_.far_cell());
        const glm::vec2 centre = grid.centre_of(std::uint32_t(texel));
        const glm::dvec3 scaled(centre.x, 0, centre.y);
        return std::uint16_t(ground_.cell(glm::vec3(scaled / facets_.scale + facets_.centre)));
    }

    const GroundCells& ground_;
    const Facets& facets_;
    const BundleTransport& transport_;
    std::vector<glm::vec3> centres_;
};

} // namespace

GroundInView::GroundInView(const PatchScene& scene, const GroundCells& ground, const Facets& facets,
                           const BundleTransport& transport, std::span<const float> down) {
    const GroundSearch search(scene, ground, facets, transport);
    const std::vector<std::uint32_t>& with_rays = transport.rays.patches;
    std::vector<Rows> blocks((facets.patch_count + kBlockInView - 1) / kBlockInView);
    parallel_blocks(facets.patch_count, kBlockInView, [&](std::size_t from, std::size_t to) {
        Rows& rows = blocks[from / kBlockInView];
        std::vector<Seen> sides[2];
        for (std::size_t p = from; p < to; ++p) {
            const auto patch = std::uint32_t(p);
            for (std::vector<Seen>& side : sides)
                side.clear();
            if (down[2 * p] == 0 && down[2 * p + 1] == 0) {
                rows.lengths.insert(rows.lengths.end(), 2, 0);
                continue;
            }
            if (const auto found = std::lower_bound(with_rays.begin(), with_rays.end(), patch);
                found != with_rays.end() && *found == patch)
                search.by_rays(std::size_t(found - with_rays.begin()), sides);
            else
                search.by_lines(patch, false, sides);
            if (sides[0].empty() && sides[1].empty()) // no line met it: its open share is a neighbour's
                search.by_lines(patch, true, sides);
            for (const std::vector<Seen>& side : sides) {
                rows.lengths.push_back(std::uint32_t(side.size()));
                rows.seen.insert(rows.seen.end(), side.begin(), side.end());
            }
        }
    });
    begin_.push_back(0);
    for (const Rows& rows : blocks) {
        const Seen* seen = rows.seen.data();
        for (std::uint32_t length : rows.lengths) {
            double sum = 0;
            for (std::uint32_t i = 0; i < length; ++i)
                sum += double(seen[i].weight);
            for (std::uint32_t i = 0; i < length; ++i, ++seen) {
                cells_.push_back(seen->cell);
                shares_.push_back(sum > 0 ? float(double(seen->weight) / sum) : 0.f);
            }
            begin_.push_back(std::uint32_t(cells_.size()));
        }
    }
}

glm::vec3 GroundInView::mean(Side side, std::span<const glm::vec3> radiance) const {
    glm::vec3 sum(0.f);
    if (begin_.empty())
        return sum;
    for (std::uint32_t i = begin_[side]; i < begin_[side + 1]; ++i)
        sum += shares_[i] * radiance[cells_[i]];
    return sum;
}

} // namespace kokage
