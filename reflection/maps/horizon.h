#pragma once
// The light that a surface can't see: what a lobe loses below the horizon (DESIGN §5). [R] eq 5 drops the test cos φ >=
// 0 and so lets light from below the horizon in; this puts it back, to first order, without more lookups.
#include "common/types.h"
#include "reflection/maps/lobe.h"

#include <vector>

namespace kokage {

/// How to look up instead of at (r, Λ): radiance = share x F(direction, parameter).
struct HorizonLookup {
    glm::vec3 direction; ///< r': mean direction of the lobe's part above the horizon
    float parameter;     ///< Λ' >= Λ: of the lobe as narrow as that part
    float share;         ///< H: that part's share of the lobe's mass
};

/// A table over (n·r, lobe), made once; thread-safe.
class HorizonTable {
  public:
    explicit HorizonTable(LobeKind kind);
    HorizonLookup lookup(const glm::vec3& normal, const glm::vec3& mirrored, double parameter) const;

  private:
    LobeKind kind_;
    int columns_ = 0, rows_ = 0;
    std::vector<glm::vec3> cells_; ///< share, sine of the turn towards the normal, Λ'/Λ
};

} // namespace kokage
