#pragma once
// Method `paper`: [F] to the letter, as the baseline to beat, for teaching and regression.
#include "foliage/method.h"

namespace kokage {

/// Maps at generations 1, n-1 and n (options.maps, 15 by default), 49 coefficients (options.bands = 7), lights and sky
/// inside the maps; leaves start black; both sides of a leaf take (rho + tau) S and bark takes albedo S, with S of eqs
/// 2-4 and no cosine; then the maps are captured again from what is now lit, and so on: options.max_bounces times, or
/// until the residual is below a tenth of options.error. A negative S, which 49 coefficients of a sun do give, counts
/// as 0: there is no negative light. Throws InputError for options out of range.
std::unique_ptr<Transport> make_paper_transport(const PatchScene& scene, const Tree& tree,
                                                const ShadingOptions& options, Progress& progress);

} // namespace kokage
