#pragma once
// Which lobes the spectral baker filters by, on grids of which size, and how each texel's lobe is put together from
// them.
#include "reflection/maps/near_sums.h"
#include "reflection/maps/texel_layout.h"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace kokage {

/// One lobe and the grid that holds everything filtered by it.
struct SpectralShell {
    Lobe lobe;
    std::vector<double> zonal; ///< its coefficients; their number is the bands that it needs
    int even_bands = 0;        ///< that suffice where no part of the image is many times brighter than its mean
    int rings = 0; ///< of its grid; twice as many columns; up to RingSynthesis::kMostGrids neighbours share it
};

/// Up to four neighbouring shells and their weights.
struct ShellMix {
    static constexpr std::size_t kMost = 4;
    std::size_t first = 0;
    std::array<float, kMost> weights{};
};

/// Lobes that harmonics of 512 bands can't hold, or whose width the image's pixels show through, have a near part that
/// is summed pixel by pixel: Phong's all of the lobe, which ends soon; GGX's as ggx_smooth_part() splits it
/// (common/directions/lobes.h), so that harmonics hold its long tails.
///
/// Errors are estimated for an image of values in [0, 1] that has as much contrast as such an image can have (variance
/// 1/4, the same in each octave) and noise in its pixels besides.
class SpectralPlan {
  public:
    /// `tolerance`: of the largest error, which is taken as five times the root mean square.
    SpectralPlan(const TexelLayout& layout, int image_width, int image_height, double tolerance);

    /// From wide lobes to narrow ones.
    const std::vector<SpectralShell>& shells() const { return shells_; }
    /// 1: every texel's lobe is one of the shells'; else interpolated between that many neighbours.
    std::size_t shells_a_texel() const { return shells_a_texel_; }
    int bands() const; ///< the most of any shell
    /// Nothing of the lobe is in harmonics.
    bool is_near_only(float parameter) const {
        return kind_ == LobeKind::phong ? parameter > narrowest_ : parameter < narrowest_;
    }
    /// What is to be summed pixel by pixel; nothing where its reach is 0.
    NearLobe near_part(float parameter) const;
    /// Of the lobe's mass, in harmonics; the shells' lobes have mass 1.
    double smooth_share(float parameter) const;
    ShellMix mix(float parameter) const;

  private:
    void find_narrowest(double needed, double pixel);
    void split_lobes(float least_parameter, double limit, int image_height);
    void tabulate_shares(float least_parameter);
    double smooth_spread() const { return sharpest_ > 0 ? 0.5 / sharpest_ : 0; }
    double lobe_width(float parameter) const; ///< where it is between shells
    Lobe lobe_of_place(double width) const;
    std::vector<double> coefficients(const Lobe& lobe, int bands) const;
    int bands_needed(const Lobe& lobe, double share) const;
    int rings_needed(std::span<const double> zonal) const;
    void add_shell(const Lobe& lobe);
    void add_shells(const std::vector<float>& parameters);
    void share_grids();

    LobeKind kind_;
    double tolerance_, noise_;
    int most_bands_;
    float narrowest_ = 0; ///< parameter of the narrowest lobe in harmonics
    double sharpest_ = 0; ///< of GGX's smooth part; 0: lobes are not split
    double least_log_roughness_ = -1;
    std::vector<double> log_shares_; ///< of masses in the smooth part, at even steps of log roughness from there to 0
    double widest_ = 0, step_ = 1;
    std::size_t shells_a_texel_ = 1;
    std::vector<float> parameters_; ///< of the shells, where every texel's lobe is one of them
    std::vector<SpectralShell> shells_;
};

} // namespace kokage
