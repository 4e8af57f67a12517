#include "reflection/maps/lobe.h"

#include "common/directions/lobes.h"
#include "common/services/error.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace kokage {

std::string_view lobe_kind_name(LobeKind kind) {
    return kind == LobeKind::phong ? "phong" : "ggx";
}

LobeKind lobe_kind_from_name(std::string_view name) {
    for (const LobeKind kind : {LobeKind::phong, LobeKind::ggx})
        if (lobe_kind_name(kind) == name)
            return kind;
    throw InputError("unknown lobe '" + std::string(name) + "': use phong or ggx");
}

std::vector<double> lobe_coefficients(const Lobe& lobe, int bands) {
    return lobe.kind == LobeKind::phong ? phong_lobe(bands, lobe.parameter) : ggx_lobe(bands, lobe.parameter);
}

double lobe_value(const Lobe& lobe, double squared_distance) {
    return lobe.kind == LobeKind::phong ? phong_lobe_value(lobe.parameter, squared_distance)
                                        : ggx_lobe_value(lobe.parameter, squared_distance);
}

int lobe_bands(const Lobe& lobe, double tolerance, int most) {
    // Coefficients oscillate under an envelope that falls, so those of twice as many bands tell: quadratures of GGX
    // that nobody needs are not made.
    for (int tried = std::min(64, most);; tried = std::min(2 * tried, most)) {
        const std::vector<double> k = lobe_coefficients(lobe, tried);
        int needed = int(k.size());
        while (needed > 1 && std::abs(k[std::size_t(needed) - 1]) < tolerance)
            --needed;
        if (tried >= most || 2 * needed <= tried)
            return needed;
    }
}

double lobe_reach(const Lobe& lobe, double share) {
    if (!(share > 0))
        return 2; // both lobes end at a right angle
    share = std::min(share, 1.0);
    // In w = 1 - t = (squared distance)/2.
    if (lobe.kind == LobeKind::phong) // (1-w)^L = share
        return lobe.parameter > 0 ? -2 * std::expm1(std::log(share) / lobe.parameter) : 2;
    // (1-w) = share (1+xw)^2: the positive root of share x^2 w^2 + (2 share x + 1) w = 1 - share.
    const double x = ggx_falloff(lobe.parameter), b = 2 * share * x + 1;
    return 4 * (1 - share) / (b + std::sqrt(b * b + 4 * share * x * x * (1 - share)));
}

} // namespace kokage
