#pragma once
// A scene's patches as flat convex polygons, the form in which lines are drawn through them.
//
// Patch -> facets -> polygons: a facet is the part of a leaf that lies in one plane (a flat leaf is one facet, a folded
// one two), or a whole piece of bark, whose front is all that light can reach. A polygon is a convex flat part of a
// facet (a rhombic leaf of two triangles is one polygon of four corners). Geometry is moved to the scene's centre and
// scaled to a diagonal of 1, so that no scene is too small or too far away.
#include "common/scene/patch_scene.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace kokage::bundles {

struct Facet {
    glm::vec3 normal{0.f}; ///< leaf: unit, front side; bark: unused
    float area = 0;        ///< solid area (alpha holes taken out) in scaled units^2; may be 0
    std::uint32_t patch = 0;
    bool bark = false;
    bool masked = false; ///< has holes
    /// Mean of n n^T over the facet's area (xx, yy, zz, xy, xz, yz), times a factor that makes projected_share() right
    /// on average: exact for flat leaves and for tubes, within a few percent for other bark.
    float form[6] = {0, 0, 0, 0, 0, 0};

    /// Projected area over area, both sides counted: the mean of |n . direction|.
    float projected_share(const glm::vec3& d) const {
        const float q = form[0] * d.x * d.x + form[1] * d.y * d.y + form[2] * d.z * d.z +
                        2 * (form[3] * d.x * d.y + form[4] * d.x * d.z + form[5] * d.y * d.z);
        return q > 0 ? std::sqrt(q) : 0.f;
    }
};

/// The alpha masks as bits, one a texel: 1 = solid. Rows of whole words, one mask after the other.
struct MaskBits {
    std::vector<std::uint32_t> words;
    std::vector<std::int32_t> first, stride;  ///< of each mask: its first word, words a row
    std::vector<float> last_column, last_row; ///< width - 1/2, height - 1/2: what texel coordinates are clamped to
    std::size_t bytes() const;
};

/// Texture coordinates of polygons with a mask, in texels, as affine functions of scaled position; one array a
/// quantity.
struct TexelMaps {
    std::vector<std::int32_t> mask;                            ///< index in PatchScene::masks and MaskBits
    std::vector<float> wraps;                                  ///< 1 = leaves the texture (which repeats, say), else 0
    std::array<std::vector<float>, 2> at_corner;               ///< [axis]: at corner 0
    std::array<std::array<std::vector<float>, 3>, 2> gradient; ///< [axis][x, y, z]
    std::size_t bytes() const;
};

/// Polygons of one corner count, all with a mask or all without; one array a quantity, in patch order; padded so that
/// whole vectors may be read.
struct PolygonGroup {
    static constexpr std::size_t kPadding = 64;
    static constexpr int kMaxCorners = 8;
    static constexpr std::uint32_t kBark = 0x80000000u; ///< flag in `face`
    int corners = 3;
    bool masked = false;
    std::size_t count = 0;
    std::array<std::vector<float>, kMaxCorners> x, y, z; ///< [corner][polygon], counter-clockwise seen from the front
    std::vector<float> normal_x, normal_y, normal_z;
    std::vector<std::uint32_t> face; ///< see Facets::face_count; bark: of the face that looks to the near end, | kBark
    TexelMaps texels;                ///< empty without masks
    std::size_t bytes() const;
};

struct Box {
    glm::vec3 low{0.f}, high{0.f};
};

struct Facets {
    double scale = 1; ///< scaled = (metres - centre) * scale
    glm::dvec3 centre{0.0};
    std::vector<PolygonGroup> groups; ///< by corners, then without and with masks; those that occur
    MaskBits mask_bits;
    std::vector<Facet> facets; ///< leaf facets first, then bark facets
    std::uint32_t leaf_facet_count = 0;
    std::vector<std::uint32_t> patch_first_facet; ///< patch count + 1
    std::vector<float> patch_area;                ///< solid area, scaled units^2
    std::uint32_t patch_count = 0;
    float mean_leaf_area = 0;      ///< of leaf patches with an area (of all patches if there is no leaf)
    glm::vec3 low{0.f}, high{0.f}; ///< bounds, scaled
    /// Patches of wood or of things so wide beside the leaves that lines dense enough for these would mostly be drawn
    /// on them (a floor, a photographer's backdrop). They get rays (ray_links.h), and no more of them is drawn than
    /// lines through the rest pass. Ascending; none where there is a ground, which wide things shade far around.
    std::vector<std::uint32_t> wide_patches;
    std::vector<Box> boxes; ///< closer bounds: together they hold all polygons but those of wide patches; scaled
    Box drawn;              ///< bounds of what `boxes` hold; the scene's where no patch is wide

    /// What a line meets is a face: leaf facet f is face f; bark facet b (counted from leaf_facet_count) has two,
    /// leaf_facet_count + 2b where its front looks to the near end of the line, + 1 where it looks to the far end.
    std::uint32_t face_count() const {
        return leaf_facet_count + 2 * (std::uint32_t(facets.size()) - leaf_facet_count);
    }
    std::uint32_t facet_of(std::uint32_t face) const {
        return face < leaf_facet_count ? face : leaf_facet_count + (face - leaf_facet_count) / 2;
    }
    std::size_t bytes() const;
};

/// Triangles without area are left out; a patch may end up without facets. Leaf patches must come before bark patches.
Facets make_facets(const PatchScene& scene);

} // namespace kokage::bundles
