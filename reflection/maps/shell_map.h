#pragma once
// The default container: shells, each a map over all directions for one lobe, as large as that lobe needs.
#include "reflection/maps/roughness_scale.h"
#include "reflection/maps/texel_layout.h"

#include <cstddef>
#include <span>
#include <vector>

namespace kokage {

/// How a texel is kept; the figures of memory are of these.
enum class TexelFormat { half_rgb, float_rgb, shared_exponent };

struct ShellSettings {
    LobeKind kind = LobeKind::phong;
    double least_parameter = 1, most_parameter = 5000; ///< the range of lobes that a scene uses
    double shell_ratio = 2;    ///< Λ of neighbouring shells (GGX: of the lobes' widths squared)
    double texels_a_width = 1; ///< resolution: texels a lobe's standard width
    TexelFormat format = TexelFormat::half_rgb;
};

/// From rough to smooth. Lookup interpolates within a shell and, between shells, linearly in 1/Λ (the lobe's width
/// squared: what a blur's second derivative is proportional to).
class ShellMap {
  public:
    struct Shell {
        Lobe lobe;
        int resolution = 0;    ///< texels along an edge of its square map, border included
        std::size_t first = 0; ///< index of its first texel
    };
    explicit ShellMap(const ShellSettings& settings);
    const std::vector<Shell>& shells() const { return shells_; }
    const TexelLayout& layout() const { return layout_; }
    void set_texels(std::span<const glm::vec3> filtered);
    std::size_t bytes() const; ///< of the texels, in their format

    /// `parameter`: Λ or roughness, as the map's kind; outside of the range that was baked, the nearest end.
    glm::vec3 lookup(const glm::vec3& direction, double parameter) const;
    void lookup(std::span<const glm::vec3> directions, std::span<const float> parameters,
                std::span<glm::vec3> filtered) const;

  private:
    ShellSettings settings_;
    std::vector<Shell> shells_;
    TexelLayout layout_;
    std::vector<std::byte> texels_;
};

} // namespace kokage
