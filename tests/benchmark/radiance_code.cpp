#include "tests/benchmark/radiance_code.h"
#include "common/services/error.h"

#include <cmath>
#include <string>

namespace kokage {

namespace {
constexpr double kStepsPerOctave = 1386.0, kLowestOctave = -24.0;
}

std::uint16_t radiance_code(float radiance) {
    if (!(radiance >= 0.f) || radiance >= 0x1p23f)
        throw InputError("reference radiance " + std::to_string(radiance) +
                         " can't be stored: it must be from 0 to 2^23; scale the scene's lights");
    if (radiance < 0x1p-24f)
        return 0;
    return std::uint16_t(1.0 + std::round(kStepsPerOctave * (std::log2(double(radiance)) - kLowestOctave)));
}

float radiance_from_code(std::uint16_t code) {
    return code == 0 ? 0.f : float(std::exp2((code - 1.0) / kStepsPerOctave + kLowestOctave));
}

} // namespace kokage
