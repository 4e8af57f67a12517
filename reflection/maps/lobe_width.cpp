#include "reflection/maps/lobe_width.h"

#include <algorithm>
#include <cmath>

namespace kokage {

double lobe_spread(const Lobe& lobe) {
    const double squared = lobe.parameter * lobe.parameter;
    return lobe.kind == LobeKind::phong ? 1 / (lobe.parameter + 1) : squared * squared;
}

Lobe lobe_of_spread(LobeKind kind, double spread) {
    return {kind, kind == LobeKind::phong ? std::max(1 / spread - 1, 0.0) : std::sqrt(std::sqrt(spread))};
}

double lobe_width(const Lobe& lobe) {
    return std::sqrt(lobe_spread(lobe));
}

Lobe lobe_of_width(LobeKind kind, double width) {
    return lobe_of_spread(kind, width * width);
}

} // namespace kokage
