#pragma once
// Small bright things seen through lobes, texel by texel: what the spectral baker keeps out of its harmonics.
#include "common/environment/environment.h"
#include "reflection/maps/texel_layout.h"

#include <cstdint>
#include <span>
#include <vector>

namespace kokage {

/// Light from one direction.
struct PointOfLight {
    glm::vec3 direction;
    glm::vec3 irradiance;
};

/// Points that lie together.
struct ClusterOfLight {
    glm::vec3 axis{0, 1, 0};
    float chord = 0;    ///< largest distance of a point's direction from the axis
    float strength = 0; ///< sum of irradiance, of the channel that has most
    std::vector<PointOfLight> points;
};

/// What stands for a light: its texels' centres; of a disc the points of a Gauss rule over it that is exact enough for
/// lobes of the variance `least_spread` and wider.
ClusterOfLight cluster_of(const DistantLight& light, double least_spread);

/// Texels sorted by lobe and direction, so that a group of them can be seen to be out of a light's reach together.
/// Prepared once for a layout.
class LobeLights {
  public:
    explicit LobeLights(const TexelLayout& layout);
    /// filtered += factors[texel] x sum over points of irradiance x lobe, but for lights that add less than
    /// `negligible` (times factors below 1); points far from a group of texels are gathered as long as that changes
    /// less than `negligible` by what is gathered in one. No factors = 1. The same bits with any number of threads.
    /// Returns how many lobes were evaluated. Relative error 1e-5 beside.
    std::uint64_t add(std::span<const ClusterOfLight> lights, float negligible, std::span<const float> factors,
                      std::span<glm::vec3> filtered) const;
    std::size_t bytes() const;

  private:
    struct Group {
        std::uint32_t begin, end;
        glm::vec3 axis;
        float chord;  ///< largest distance of a texel's direction from the axis
        float widest; ///< parameter of the widest lobe
        float peak;   ///< largest value of any of the lobes
        float least_shape, most_shape;
    };
    void make_groups(const TexelLayout& layout, std::uint32_t begin, std::uint32_t end);

    LobeKind kind_;
    std::vector<Group> groups_;
    std::vector<std::uint32_t> texels_;           ///< in the layout, group by group
    std::vector<float> x_, y_, z_, shape_, peak_; ///< of these; padded to whole vectors. shape: Λ, or ggx_falloff()
};

} // namespace kokage
