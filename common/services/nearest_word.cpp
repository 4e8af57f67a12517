#include "common/services/nearest_word.h"

#include <algorithm>
#include <numeric>

namespace kokage {
namespace {

std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t(0));
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t above = row[j];
            row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0u : 1u)});
            diagonal = above;
        }
    }
    return row[b.size()];
}

} // namespace

std::optional<std::string> nearest_word(std::string_view word, const std::vector<std::string>& words) {
    const std::string_view begin = word.substr(0, 80); // far more than any of ours
    std::optional<std::string> nearest;
    std::size_t least = std::max<std::size_t>(1, begin.size() / 2) + 1;
    for (const std::string& candidate : words)
        if (const std::size_t distance = edit_distance(begin, candidate); distance < least) {
            least = distance;
            nearest = candidate;
        }
    return nearest;
}

} // namespace kokage
