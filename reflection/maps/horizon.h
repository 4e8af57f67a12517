#pragma once
// The light that a surface can't see: what a lobe loses below the horizon (DESIGN §5). [R] eq 5 drops the test cos φ >=
// 0 and so lets light from below the horizon in; this takes it out, to second order, with one or two lookups in the
// same map.
#include "common/types.h"
#include "reflection/maps/lobe.h"

#include <span>
#include <string_view>
#include <vector>

namespace kokage {

enum class HorizonCorrection {
    none,        ///< [R] eq 3: radiance = F(r, Λ)
    one_lookup,  ///< share, mean direction and width of the lobe's part above the horizon
    two_lookups, ///< that part is narrower across the horizon than along it: two lobes beside each other (default)
};
std::string_view horizon_correction_name(HorizonCorrection correction);
/// "none", "one-lookup", "two-lookups"; throws InputError that lists them.
HorizonCorrection horizon_correction_from_name(std::string_view name);

/// How to look up instead of at (r, Λ): radiance = share x mean over `count` of F(directions[i], parameter).
struct HorizonLookup {
    glm::vec3 directions[2];
    int count;       ///< 1 or 2
    float parameter; ///< of a lobe as narrow as the part above the horizon: Λ' >= Λ, roughness' <= roughness
    float share;     ///< that part's share of the lobe's mass
};

/// A table over (n·r, lobe), made once (some 30 ms); thread-safe. On a GPU: horizon.glsl. Errors of one and two lookups
/// against the clipped lobe are in horizon.cpp.
class HorizonTable {
  public:
    explicit HorizonTable(LobeKind kind, HorizonCorrection correction = HorizonCorrection::two_lookups);
    /// `normal` and `mirrored` are unit; the mirrored direction may lie below the horizon, as those of smoothed normals
    /// do. `parameter`: Phong's Λ > 0, GGX's roughness in (0,1].
    HorizonLookup lookup(const glm::vec3& normal, const glm::vec3& mirrored, double parameter) const;

    static constexpr int columns = 97, rows = 33;
    /// Row by row, a row a lobe's width, a column an elevation of the mirrored direction (horizon.cpp): share; turn
    /// towards the normal and half the distance of the two lookups, in the lobe's widths; Phong: (Λ+3)/(Λ'+3), GGX:
    /// α'/α. Empty without a correction.
    std::span<const glm::vec4> cells() const { return cells_; }

  private:
    LobeKind kind_;
    HorizonCorrection correction_;
    std::vector<glm::vec4> cells_;
};

/// Radiance through a lobe above the horizon, from any map: look_up(direction, parameter).
template <typename LookUp>
glm::vec3 filtered_above_horizon(const HorizonTable& table, const glm::vec3& normal, const glm::vec3& mirrored,
                                 double parameter, LookUp&& look_up) {
    const HorizonLookup at = table.lookup(normal, mirrored, parameter);
    glm::vec3 sum = look_up(at.directions[0], at.parameter);
    if (at.count == 2)
        sum = 0.5f * (sum + look_up(at.directions[1], at.parameter));
    return at.share * sum;
}

} // namespace kokage
