#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace kokage {

/// "30,000"
std::string count_text(std::uint64_t count);
/// "1 leaf", "30,000 leaves"
std::string counted(std::uint64_t count, std::string_view one, std::string_view many);

} // namespace kokage
