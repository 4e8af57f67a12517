#pragma once
// The default container: shells, each a map over all directions for one lobe, as large as that lobe needs.
//
// A shell is six square faces (face_chart.h), one after another, `resolution` texels wide, rows of v, u fastest:
//
//        o---o---o---o      resolution 4: texels (o) stand ON the edges, at u, v = -1, -1/3, 1/3, 1, so that the faces
//        |   |   |   |      that meet at an edge hold the same values along it and bilinear lookup makes no step there.
//        o---o---o---o      spacing at the middle of a face: h = (π/2) / (resolution - 1) radians.
//        |   |   |   |
//        o---o---o---o
//
// A shell's lobe is `lobe`; what its texels hold is filtered by the slightly narrower lobe `texel_lobe`: bilinear
// interpolation itself blurs by a hat of variance h²/6, which texels that are that much sharper make up for.
#include "reflection/maps/roughness_scale.h"
#include "reflection/maps/texel_format.h"
#include "reflection/maps/texel_layout.h"

#include <cstddef>
#include <span>
#include <vector>

namespace kokage {

struct ShellSettings {
    LobeKind kind = LobeKind::phong;
    double least_parameter = 1, most_parameter = 5000; ///< the range of lobes that a scene uses; may be one lobe
    double shell_ratio = 2;                            ///< at most, between neighbouring shells' lobe_spread
    double texels_a_width = 1.5; ///< resolution: texels a lobe's standard width, sqrt(lobe_spread)
    TexelFormat format = TexelFormat::half_rgb;
};

/// The variable in which shells are spaced (geometrically) and interpolated (linearly): a lobe's variance, to which the
/// change that its blur makes is proportional. Phong: 1/(Λ+1); GGX: roughness⁴ (α²).
double lobe_spread(const Lobe& lobe);
Lobe lobe_of_spread(LobeKind kind, double spread);

/// From rough to smooth. Lookup interpolates within a shell and, between shells, linearly in lobe_spread.
class ShellMap {
  public:
    struct Shell {
        Lobe lobe;             ///< what a lookup with just this parameter means
        Lobe texel_lobe;       ///< what the texels are filtered by
        int resolution = 0;    ///< texels along a face's edge
        std::size_t first = 0; ///< index of its first texel; it has 6 resolution²
    };
    /// Throws InputError where the settings make no sense.
    explicit ShellMap(const ShellSettings& settings);
    const ShellSettings& settings() const { return settings_; }
    const std::vector<Shell>& shells() const { return shells_; }
    const TexelLayout& layout() const { return layout_; }
    void set_texels(std::span<const glm::vec3> filtered);         ///< in the layout's order
    std::span<const std::byte> texels() const { return texels_; } ///< in the settings' format
    std::size_t bytes() const { return texels_.size(); }          ///< of the texels, in their format

    /// `parameter`: Λ or roughness, as the map's kind; outside of the range that was baked, the nearest end.
    /// Thread-safe.
    glm::vec3 lookup(const glm::vec3& direction, double parameter) const;
    void lookup(std::span<const glm::vec3> directions, std::span<const float> parameters,
                std::span<glm::vec3> filtered) const;

  private:
    glm::vec3 shell_lookup(const Shell& shell, int face, float u, float v) const;

    ShellSettings settings_;
    std::vector<Shell> shells_;
    TexelLayout layout_;
    std::vector<std::byte> texels_;
};

} // namespace kokage
