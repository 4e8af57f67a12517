#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace kokage {

/// The word that takes the fewest insertions, removals and exchanges of letters (Levenshtein's distance) to become
/// `word`; the first of them where several are as near. None where the nearest has hardly a letter in common: it is
/// no slip of the finger then.
std::optional<std::string> nearest_word(std::string_view word, const std::vector<std::string>& words);

} // namespace kokage
