#include "foliage/bundles/light_beams.h"

#include "common/services/random.h"

#include <algorithm>

namespace kokage::bundles {

std::vector<Beam> make_beams(const DistantLight& light, int count, std::uint64_t seed) {
    const int half = std::max(1, (count + 1) / 2);
    std::vector<Beam> beams(2 * std::size_t(half));
    for (int h = 0; h < 2; ++h) {
        Random random(seed, std::uint64_t(h));
        const float shift = random.uniform();
        for (int i = 0; i < half; ++i) {
            // Stratified in the first coordinate, a shifted golden-ratio sequence in the second.
            const float u0 = (float(i) + random.uniform()) / float(half);
            const float golden = shift + 0.618034f * float(i);
            const LightSample sample = sample_light(light, std::min(u0, 0.9999999f), golden - std::floor(golden));
            beams[2 * std::size_t(i) + h] = {sample.direction, sample.irradiance_over_pdf / float(half)};
        }
    }
    return beams;
}

} // namespace kokage::bundles
