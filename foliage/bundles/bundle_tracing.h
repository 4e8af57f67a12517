#pragma once
// Who sees whom: line bundles drawn once, kept as open fractions (ends of lines) and links (neighbours on lines).
#include "common/services/progress.h"
#include "foliage/bundles/facets.h"
#include "foliage/bundles/line_directions.h"
#include "foliage/bundles/line_raster.h"
#include "foliage/bundles/links.h"
#include "foliage/bundles/ray_links.h"

#include <limits>
#include <optional>

namespace kokage::bundles {

/// Of each direction and facet, which share of its lines reaches the near / far end of the line: 0 ... 254 = 0 ... 1.
/// kUnseen: no line of this direction met the facet.
struct OpenFractions {
    static constexpr std::uint8_t kUnseen = 255;
    std::size_t facet_count = 0;
    /// Of a facet that is met head on, in pixels per scaled unit^2; infinity = every facet is met.
    float pixels_per_area = std::numeric_limits<float>::infinity();
    std::vector<std::uint8_t> near_end, far_end; ///< [direction][facet]; far_end is empty for lights
    const std::uint8_t* near_row(std::size_t direction) const { return near_end.data() + direction * facet_count; }
    const std::uint8_t* far_row(std::size_t direction) const { return far_end.data() + direction * facet_count; }
};

/// `directions`: of the lines that will light it and look at it. Small texels show more, but few lines light them
/// noisily.
GroundGrid make_ground_grid(const Facets& facets, float height_m, int directions);

struct BundleSettings {
    int sky_directions = 24;  ///< lines that only show their ends
    int link_directions = 16; ///< lines that show all their neighbours
    float sky_pixels = 4;     ///< mean pixels a leaf
    float link_pixels = 2;    ///< more directions beat more pixels: neighbours in one direction are much the same
    std::uint64_t seed = 1;
};

/// Pixels a unit length so that a leaf of mean size covers `pixels` on average; fewer where the picture would be too
/// large.
float pixel_density(const Facets& facets, float pixels);

/// Draws the bundles. The result does not depend on the number of threads.
struct BundleTransport {
    LineDirections sky_lines, link_lines;
    OpenFractions sky_open, link_open;
    std::optional<GroundGrid> ground;
    Links links;
    RayLinks rays; ///< of leaves that are too small for lines; see ray_link_tracing.h
    std::size_t fragments = 0;
    std::size_t bytes() const;
};
BundleTransport trace_bundles(const PatchScene& scene, const Facets& facets, const BundleSettings& settings,
                              Progress& progress);

/// Visibility towards directions of lights: near_end of a raster along each -direction_to_light; shadows on the ground.
struct BeamVisibility {
    OpenFractions open;                            ///< near_end only
    std::vector<std::vector<float>> ground_shadow; ///< [beam][texel]: shaded share, 0 ... 1; empty without ground
};
BeamVisibility trace_beams(const PatchScene& scene, const Facets& facets, const std::optional<GroundGrid>& ground,
                           const std::vector<glm::vec3>& directions_to_light, float pixels, std::uint64_t seed);

} // namespace kokage::bundles
