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

/// Points that stand for a light: its texels at their centres; a disc as a Gauss rule over it that is exact for lobes
/// of the variance `least_spread` and wider.
void append_points(const DistantLight& light, double least_spread, std::vector<PointOfLight>& points);

/// Which texels lie together, prepared once for a layout.
class LobeLights {
  public:
    explicit LobeLights(const TexelLayout& layout);
    /// filtered += factors[texel] x sum over points of irradiance x lobe, where that exceeds `negligible`; no factors =
    /// 1. The same bits with any number of threads. Returns how many lobes were evaluated.
    std::uint64_t add(std::span<const PointOfLight> points, float negligible, std::span<const float> factors,
                      std::span<glm::vec3> filtered) const;

  private:
    struct Group {
        std::uint32_t begin, end;
        glm::vec3 axis;
        float half_angle;
        float widest; ///< parameter of the widest lobe
    };
    const TexelLayout& layout_;
    std::vector<Group> groups_;
};

} // namespace kokage
