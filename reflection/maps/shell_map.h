#pragma once
// The default container: shells, each a map over all directions for one lobe, as large as that lobe needs.
//
// A shell is six square faces (face_chart.h), one after another, rows of growing v, u fastest:
//
//        .   .   .   .   .   .      resolution 4: texels (o) stand ON the edges, at u, v = -1, -1/3, 1/3, 1: faces
//          +---------------+        that meet at an edge have the same places along it, so lookups make no step there.
//        . o   o   o   o . .        Spacing at the middle of a face: h = (π/2) / (resolution - 1) radians.
//          |               |
//        . o   o   o   o   .        . border beyond the edges (u, v = ±(1 + 2/3), ...), in the chart of the same face:
//          |               |             layout()  stored
//        . o   o   o   o   .   bilinear      1         0
//          |               |   cubic         5         1
//        . o   o   o   o   .
//          +---------------+        layout(): what a baker filters, border included, plainly F(direction, lobe).
//        .   .   .   .   .   .      texels(): what lookups read, made of that by set_texels().
//
// What is stored is not F at the texel but what makes the interpolation between texels fit F best:
//  - bilinear: interpolation blurs by a hat of variance h²/6 an axis; each texel is sharpened by the taps
//    (-1, 14, -1)/12 along both axes, which undo that: 0.4 of the error at the same size.
//  - cubic: the coefficients of a uniform B-spline (Unser 1999), by a symmetric filter of nine taps. On a GPU four
//    bilinear reads instead of one (Sigg and Hadwiger, GPU Gems 2, chapter 20).
//
// Shells are spaced evenly in width^0.2 (lobe_width.h), so that they are closer (in ratio) where they are rough and
// cheap, and interpolated linearly in width: 1/sqrt(Λ+1), or α. Both were measured: interpolation in 1/Λ has 1.4 times
// the error. Errors between texels and shells, photograph | colour pattern, 512x256 in [0,1], Λ = 1 … 5000, in 1/255:
// see reflection/README.md.
#include "reflection/maps/lobe_width.h"
#include "reflection/maps/texel_format.h"
#include "reflection/maps/texel_layout.h"

#include <cstddef>
#include <span>
#include <vector>

namespace kokage {

struct ShellTable;

enum class TexelFilter {
    bilinear, ///< one bilinear read a shell
    cubic,    ///< B-spline: smooth, and a third of the error or less; four bilinear reads a shell on a GPU
};

struct ShellSettings {
    LobeKind kind = LobeKind::phong;
    double least_parameter = 1, most_parameter = 5000; ///< the range of lobes that a scene uses; may be one lobe
    TexelFilter filter = TexelFilter::bilinear;
    TexelFormat format = TexelFormat::half_rgb;
    double shell_ratio = 1.41421356; ///< at most, of neighbouring shells' widths at the smooth end; less at the rough
    double texels_a_width = 1.15;    ///< at least, at the middle of a face; no shell has less than 16 along an edge
};

/// From rough to smooth. Lookup interpolates within a shell and, between shells, linearly in lobe_width.
class ShellMap {
  public:
    struct Shell {
        Lobe lobe;
        float width = 0;             ///< lobe_width
        int resolution = 0;          ///< texels along a face's edge, without border
        std::size_t first = 0;       ///< index of its first stored texel; 6 (resolution + 2 border)² follow
        std::size_t first_baked = 0; ///< index of its first texel in layout(); 6 (resolution + 2 baked_border)² follow
    };
    /// The shells that a map with these settings has, before any memory is taken. Throws InputError where the settings
    /// make no sense.
    static std::vector<Shell> plan(const ShellSettings& settings);
    explicit ShellMap(const ShellSettings& settings); ///< as plan()
    const ShellSettings& settings() const { return settings_; }
    const std::vector<Shell>& shells() const { return shells_; }
    const TexelLayout& layout() const { return layout_; } ///< for a baker
    int border() const { return border(settings_.filter); }
    int baked_border() const { return baked_border(settings_.filter); }
    static int border(TexelFilter filter) { return filter == TexelFilter::cubic ? 1 : 0; }
    static int baked_border(TexelFilter filter) { return filter == TexelFilter::cubic ? 5 : 1; }

    void set_texels(std::span<const glm::vec3> filtered); ///< in the layout's order
    std::size_t texel_count() const { return texel_count_; }
    std::size_t bytes() const { return texel_count_ * texel_bytes(settings_.format); }      ///< of the stored texels
    std::span<const std::byte> texels() const { return std::span(texels_).first(bytes()); } ///< stored, in their format
    void restore_texels(std::span<const std::byte> stored);                                 ///< what texels() gave

    /// `direction` unit; `parameter`: Λ or roughness, as the map's kind; outside of the range that was baked, the
    /// nearest end. Nothing negative. Thread-safe.
    glm::vec3 lookup(const glm::vec3& direction, double parameter) const;
    /// Many, by vectors and threads: the same within 1e-5 of the texels' size.
    void lookup(std::span<const glm::vec3> directions, std::span<const float> parameters,
                std::span<glm::vec3> filtered) const;

    /// Where among the shells a width stands: between `index` and index + 1, `share` of the latter.
    struct Between {
        int index;
        float share;
    };
    Between between(float width) const;
    /// index = floor((first_power - width^spacing_power) x shells_a_power): how shaders and vector code find it.
    static constexpr float spacing_power = 0.2f;
    float first_power() const { return first_power_; }
    float shells_a_power() const { return shells_a_power_; }

  private:
    ShellTable table() const;
    glm::vec3 shell_lookup(const Shell& shell, int face, float u, float v) const;

    ShellSettings settings_;
    std::vector<Shell> shells_;
    float first_power_ = 1, shells_a_power_ = 0;
    std::size_t texel_count_ = 0;
    TexelLayout layout_;
    std::vector<std::byte> texels_; ///< and four bytes, which vector code may read
};

} // namespace kokage
