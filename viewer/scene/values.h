#pragma once
// Values as they stand on the command line.
#include "common/types.h"
#include "viewer/scene/cli_forward.h"

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace kokage {

/// Numbers separated by commas, "0.1,0.25,0.06". `what` names the option in messages. Throws InputError unless every
/// part is a finite number.
std::vector<double> numbers_from(std::string_view text, std::string_view what);

/// A colour: one number for all channels, or three. Throws InputError unless each is in 0..highest.
glm::vec3 color_from(std::string_view text, std::string_view what, float highest = 1.f);

/// A picture's size, "1280x960". Throws InputError unless both are in 1..32768.
struct Size {
    int width = 0, height = 0;
};
Size size_from(std::string_view text, std::string_view what);

/// A check for options that take a whole number from 0: without it CLI11 reads -1 as 2^64 - 1.
CLI::Validator whole_number(std::uint64_t most = std::numeric_limits<std::uint64_t>::max());

/// "3.42 s", "12 ms", "2 min 05 s".
std::string duration_text(double seconds);
/// "1.2 MB".
std::string bytes_text(double bytes);

} // namespace kokage
