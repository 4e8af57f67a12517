#include "viewer/scene/values.h"
#include "common/services/error.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <cstdio>

namespace kokage {
namespace {

[[noreturn]] void refuse(std::string_view text, std::string_view what, const std::string& wanted) {
    throw InputError(std::string(what) + ": '" + std::string(text) + "' is not " + wanted);
}

bool number_from(std::string_view text, double& value) {
    while (!text.empty() && text.front() == ' ')
        text.remove_prefix(1);
    while (!text.empty() && text.back() == ' ')
        text.remove_suffix(1);
    if (!text.empty() && text.front() == '+')
        text.remove_prefix(1);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return !text.empty() && error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
}

} // namespace

std::vector<double> numbers_from(std::string_view text, std::string_view what) {
    std::vector<double> numbers;
    for (std::size_t begin = 0;;) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        double value = 0;
        if (!number_from(text.substr(begin, end - begin), value))
            refuse(text, what, "a list of numbers such as 0.1,0.25,0.06");
        numbers.push_back(value);
        if (end == text.size())
            return numbers;
        begin = end + 1;
    }
}

glm::vec3 color_from(std::string_view text, std::string_view what, float highest) {
    const std::vector<double> numbers = numbers_from(text, what);
    char range[64];
    std::snprintf(range, sizeof range, "one number or three (red,green,blue) from 0 to %g", double(highest));
    if (numbers.size() != 1 && numbers.size() != 3)
        refuse(text, what, range);
    for (double number : numbers)
        if (!(number >= 0 && number <= double(highest)))
            refuse(text, what, range);
    return numbers.size() == 1 ? glm::vec3(float(numbers[0]))
                               : glm::vec3(float(numbers[0]), float(numbers[1]), float(numbers[2]));
}

Size size_from(std::string_view text, std::string_view what) {
    const std::size_t cross = text.find_first_of("xX");
    Size size;
    double width = 0, height = 0;
    if (cross == std::string_view::npos || !number_from(text.substr(0, cross), width) ||
        !number_from(text.substr(cross + 1), height) || width != std::floor(width) || height != std::floor(height) ||
        !(width >= 1 && width <= 32768 && height >= 1 && height <= 32768))
        refuse(text, what, "a size such as 1280x960 (each from 1 to 32768)");
    size.width = int(width);
    size.height = int(height);
    return size;
}

CLI::Validator whole_number(std::uint64_t most) {
    return CLI::Validator(
        [most](const std::string& text) {
            std::uint64_t value = 0;
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
            const bool good = error == std::errc() && end == text.data() + text.size() && value <= most;
            return good ? "" : "'" + text + "' is not a whole number from 0 to " + std::to_string(most);
        },
        "");
}

std::string duration_text(double seconds) {
    char text[48];
    if (seconds < 0.9995)
        std::snprintf(text, sizeof text, "%.0f ms", 1000 * seconds);
    else if (seconds < 60)
        std::snprintf(text, sizeof text, "%.2f s", seconds);
    else
        std::snprintf(text, sizeof text, "%d min %02d s", int(seconds) / 60, int(seconds) % 60);
    return text;
}

std::string bytes_text(double bytes) {
    const char* units[] = {"B", "kB", "MB", "GB", "TB"};
    int unit = 0;
    for (; bytes >= 999.5 && unit < 4; ++unit)
        bytes /= 1000;
    char text[32];
    std::snprintf(text, sizeof text, bytes < 9.95 && unit > 0 ? "%.1f %s" : "%.0f %s", bytes, units[unit]);
    return text;
}

} // namespace kokage
