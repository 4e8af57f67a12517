#pragma once
// Numbers as text that other programs read back.
#include <optional>
#include <string>

namespace kokage {

/// The shortest text that reads back as the same number.
std::string number_text(double value);
/// Nothing for what is no finite number.
std::optional<double> number_from_text(const std::string& text);

} // namespace kokage
