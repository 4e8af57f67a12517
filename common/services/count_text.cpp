#include "common/services/count_text.h"

#include <cmath>
#include <cstdio>

namespace kokage {
namespace {

/// As many digits as are of use; whole numbers with thousands marked where they are longer, powers of ten beyond that.
std::string short_text(double value, int digits) {
    if (value >= 999.5 && value < 1e9)
        return count_text(std::uint64_t(std::llround(value)));
    char text[32];
    std::snprintf(text, sizeof text, "%.*g", digits, value);
    return text;
}

} // namespace

std::string count_text(std::uint64_t count) {
    std::string text = std::to_string(count);
    for (int place = int(text.size()) - 3; place > 0; place -= 3)
        text.insert(std::size_t(place), ",");
    return text;
}

std::string counted(std::uint64_t count, std::string_view one, std::string_view many) {
    return count_text(count) + " " + std::string(count == 1 ? one : many);
}

std::string length_text(double metres) {
    if (metres > 0 && metres < 0.00995)
        return short_text(1000 * metres, 3) + " mm";
    if (metres > 0 && metres < 0.995)
        return short_text(100 * metres, 3) + " cm";
    return short_text(metres, 3) + " m";
}

std::string area_text(double square_metres) {
    if (square_metres > 0 && square_metres < 1e-5)
        return short_text(1e6 * square_metres, 3) + " mm2";
    if (square_metres > 0 && square_metres < 0.1)
        return short_text(1e4 * square_metres, 3) + " cm2";
    return short_text(square_metres, 4) + " m2";
}

} // namespace kokage
