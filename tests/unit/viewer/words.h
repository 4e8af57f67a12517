#pragma once
// The words of a command line.
#include <string>
#include <vector>

namespace kokage {

using Words = std::vector<std::string>;

inline Words joined(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

} // namespace kokage
