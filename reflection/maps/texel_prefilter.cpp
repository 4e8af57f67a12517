#include "reflection/maps/texel_prefilter.h"

#include <array>

namespace kokage {

// Linear interpolation of samples a distance h apart has, between them, the error f'' h²/2 x(1-x), whose mean is
// f'' h²/12. Taking that off the samples (second difference = f'' h²) leaves f'' h²/2 (x(1-x) - 1/6): the best in the
// mean square, to this order, that linear pieces can do.
SymmetricTaps bilinear_prefilter() {
    static constexpr std::array taps = {14.0 / 12, -1.0 / 12};
    return taps;
}

// The B-spline through samples has the coefficients c * (1, 4, 1)/6 = f (Unser, "Splines: a perfect fit for signal and
// image processing", 1999, eq 11). The inverse of that filter is infinite; these nine taps are its least-squares fit
// over frequencies w with the weight exp(-w²)/(0.01+w²) (a picture's spectrum through a lobe of one texel's width),
// with the sum 1 and the exact second moment: the product with (2 + cos w)/3 is 1 within 1e-4 up to w = 1, within
// 2e-3 up to w = 2.
SymmetricTaps cubic_prefilter() {
    static constexpr double a1 = -0.44705697153161045, a2 = 0.10976985899737911, a3 = -0.02261975189510843,
                            a4 = 0.0028055397457127005;
    static constexpr std::array taps = {1 - 2 * (a1 + a2 + a3 + a4), a1, a2, a3, a4};
    return taps;
}

std::vector<glm::vec3> prefiltered(std::span<const glm::vec3> samples, int width, SymmetricTaps taps, int skipped) {
    const int reach = int(taps.size()) - 1, cut = reach + skipped, kept = width - 2 * cut;
    std::vector<glm::dvec3> rows(std::size_t(width) * std::size_t(kept)); // filtered along u, all rows
    const auto filter = [&](const auto* centre, std::ptrdiff_t step) {
        glm::dvec3 sum = taps[0] * glm::dvec3(*centre);
        for (int k = 1; k <= reach; ++k)
            sum += taps[std::size_t(k)] * (glm::dvec3(centre[-k * step]) + glm::dvec3(centre[k * step]));
        return sum;
    };
    for (int y = 0; y < width; ++y)
        for (int x = 0; x < kept; ++x)
            rows[std::size_t(y * kept + x)] = filter(&samples[std::size_t(y * width + x + cut)], 1);
    std::vector<glm::vec3> texels(std::size_t(kept) * std::size_t(kept));
    for (int y = 0; y < kept; ++y)
        for (int x = 0; x < kept; ++x)
            texels[std::size_t(y * kept + x)] = glm::vec3(filter(&rows[std::size_t((y + cut) * kept + x)], kept));
    return texels;
}

} // namespace kokage
