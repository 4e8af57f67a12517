#pragma once
// The lobe of a reflection map: what a glossy surface's mirrored view direction is blurred by.
#include <string_view>
#include <vector>

namespace kokage {

enum class LobeKind {
    phong, ///< clamped and normalised: (Λ+1)/(2π) max(t, 0)^Λ, [R] eqs 5 and 9
    ggx,   ///< what glTF's roughness means, seen along the normal (n = v = r), as prefiltered maps of engines hold it
};
std::string_view lobe_kind_name(LobeKind kind);
/// "phong" or "ggx"; throws InputError that lists them.
LobeKind lobe_kind_from_name(std::string_view name);

/// Zonal around the mirrored view direction, of mass 1 over the sphere.
struct Lobe {
    LobeKind kind = LobeKind::phong;
    double parameter = 1; ///< Phong: the exponent Λ >= 0 (larger is smoother); GGX: glTF's roughness in (0,1]: of D(h),
                          ///< alpha = roughness²
};

/// Zonal coefficients (common/directions/zonal.h), k_0 = 1.
std::vector<double> lobe_coefficients(const Lobe& lobe, int bands);
/// Its value between unit directions a and b, from |a-b|^2.
double lobe_value(const Lobe& lobe, double squared_distance);
/// Bands after which every coefficient is below `tolerance`, at most `most` (judged by twice as many bands).
int lobe_bands(const Lobe& lobe, double tolerance, int most);
/// The squared distance beyond which the lobe's value is below `share` of its peak; at most 2, where both lobes end.
double lobe_reach(const Lobe& lobe, double share);

} // namespace kokage
