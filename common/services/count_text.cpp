#include "common/services/count_text.h"

namespace kokage {

std::string count_text(std::uint64_t count) {
    std::string text = std::to_string(count);
    for (int place = int(text.size()) - 3; place > 0; place -= 3)
        text.insert(std::size_t(place), ",");
    return text;
}

std::string counted(std::uint64_t count, std::string_view one, std::string_view many) {
    return count_text(count) + " " + std::string(count == 1 ? one : many);
}

} // namespace kokage
