#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace kokage {

/// "30,000"
std::string count_text(std::uint64_t count);
/// "1 leaf", "30,000 leaves"
std::string counted(std::uint64_t count, std::string_view one, std::string_view many);
/// "2.5 mm", "43 cm", "12.4 m", "5,060 m"
std::string length_text(double metres);
/// "3.2 mm2", "83 cm2", "12.43 m2", "12,430 m2"
std::string area_text(double square_metres);

} // namespace kokage
