#pragma once
// From the fragments of a direction's picture to links: which sides face each other on lines of this direction, and
// which face the ground.
#include "foliage/bundles/facets.h"
#include "foliage/bundles/fragment_lists.h"
#include "foliage/bundles/line_raster.h"
#include "foliage/bundles/links.h"

#include <optional>

namespace kokage::bundles {

/// A side, and whether it is the inside of wood.
struct FacingSide {
    static constexpr std::uint32_t kInsideWood = 0x80000000u;
    std::uint32_t value;
    Side side() const { return value & ~kInsideWood; }
    bool inside_wood() const { return (value & kInsideWood) != 0; }
};

/// What the leaves' sides are told by: one array a quantity, leaf facet by leaf facet.
struct LeafPlanes {
    std::vector<float> normal_x, normal_y, normal_z;
    std::vector<Side> front;
};
LeafPlanes leaf_planes(const Facets& facets);

/// The side of every face (Facets::face_count) that looks to the near end of lines of a direction:
/// FacingSide::value. To the far end looks the other side of the same patch.
void near_sides(const Facets& facets, const LeafPlanes& leaves, const glm::vec3& direction,
                std::vector<std::uint32_t>& sides);

/// Where pixel (0, 0)'s line meets the ground, and how that moves from pixel to pixel. Invalid: lines too flat to stay
/// on the grid.
struct GroundProjection {
    glm::vec2 origin, along_u, along_v;
    bool valid = false;
};
GroundProjection project_to_ground(const GroundGrid& grid, const Projection& projection);

/// Sides that face each other, FacingSide::value: a[i] looks along the line to b[i], which looks back.
struct DirectionLinks {
    UninitializedVector<std::uint32_t> a, b;
    std::vector<Links::GroundLink> ground;
};

/// What the walls inside wood see of each other is nobody's light and is left out; leaves that reach into the wood
/// (most do, at their stalk) see the dark wall. With a ground, every kStride-th line of every kStride-th row is
/// followed to it; `phase` says from which on. `sides`: near_sides().
void collect_links(const RasterScratch& raster, const Facets& facets, const Projection& projection,
                   const std::vector<std::uint32_t>& sides, const std::optional<GroundGrid>& ground,
                   std::uint32_t phase, DirectionLinks& out);

} // namespace kokage::bundles
