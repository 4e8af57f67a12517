#pragma once
// Rows of the tables that hold a benchmark's figures beside their targets.
#include <optional>
#include <string>

namespace kokage {

/// "| what | measured | ≤ target | met |": met, short in bold, or not measured.
std::string at_most(const std::string& what, std::optional<double> measured, double target, const std::string& unit);
/// The same for what has to reach a target.
std::string at_least(const std::string& what, std::optional<double> measured, double target, const std::string& unit);
/// The head of such a table.
std::string target_head();

/// Nothing times something is nothing.
std::optional<double> times(std::optional<double> value, double factor);

} // namespace kokage
