#include "common/environment/light_description.h"
#include "common/environment/analytic_sky.h"
#include "common/services/error.h"

#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

namespace kokage {
namespace {

struct Kind {
    std::string_view name, parts;
    std::size_t before_color, after_color; ///< numbers before and after R,G,B
};
constexpr Kind kinds[] = {{"sun", "AZIMUTH,ELEVATION,R,G,B", 2, 0},
                          {"disc", "AZIMUTH,ELEVATION,R,G,B,HALF_ANGLE", 2, 1},
                          {"directional", "AZIMUTH,ELEVATION,R,G,B", 2, 0},
                          {"point", "X,Y,Z,R,G,B", 3, 0}};

[[noreturn]] void fail(std::string_view description, const std::string& why) {
    throw InputError("light '" + std::string(description) + "': " + why);
}

std::vector<double> parse_numbers(std::string_view description, std::string_view list) {
    std::vector<double> numbers;
    for (std::size_t begin = 0;;) {
        const std::size_t end = std::min(list.find(',', begin), list.size());
        const std::string part(list.substr(begin, end - begin));
        char* rest = nullptr;
        const double value = std::strtod(part.c_str(), &rest);
        if (rest == part.c_str() || *rest != 0 || !std::isfinite(value))
            fail(description, "'" + part + "' is not a number");
        numbers.push_back(value);
        if (end == list.size())
            return numbers;
        begin = end + 1;
    }
}

const Kind& kind_named(std::string_view description, std::string_view name) {
    std::string known;
    for (const Kind& kind : kinds) {
        if (kind.name == name)
            return kind;
        known += (known.empty() ? "" : ", ") + std::string(kind.name) + ":" + std::string(kind.parts);
    }
    fail(description, "there is no kind '" + std::string(name) + "'; write " + known);
}

DistantLight make_distant(std::string_view description, const Kind& kind, const std::vector<double>& numbers,
                          const glm::vec3& color) {
    if (std::abs(numbers[1]) > 90)
        fail(description, "the elevation must be between -90 and 90 degrees");
    double half_angle_degrees = kind.name == "sun" ? sun_half_angle_degrees : 0;
    if (kind.name == "disc") {
        half_angle_degrees = numbers.back();
        if (!(half_angle_degrees > 0 && half_angle_degrees <= 90))
            fail(description, "the half angle must be above 0 and at most 90 degrees");
    }
    DistantLight light;
    light.name = std::string(description);
    light.direction = direction_from_azimuth_elevation(numbers[0], numbers[1]);
    light.half_angle = float(half_angle_degrees * kPiDouble / 180);
    light.irradiance = color;
    return light;
}

} // namespace

std::variant<DistantLight, PointLight> parse_light(std::string_view description) {
    const std::size_t colon = description.find(':');
    const Kind& kind = kind_named(description, description.substr(0, colon));
    const std::string wanted = std::string(kind.name) + ":" + std::string(kind.parts);
    if (colon == std::string_view::npos)
        fail(description, "numbers are missing; write " + wanted);
    std::vector<double> numbers = parse_numbers(description, description.substr(colon + 1));
    const std::size_t others = kind.before_color + kind.after_color;
    if (numbers.size() == others + 1) // one grey instead of three channels
        numbers.insert(numbers.begin() + std::ptrdiff_t(kind.before_color), 2, numbers[kind.before_color]);
    if (numbers.size() != others + 3)
        fail(description, "it has " + std::to_string(numbers.size()) + " numbers; write " + wanted);
    glm::vec3 color(0);
    for (std::size_t c = 0; c < 3; ++c) {
        const double value = numbers[kind.before_color + c];
        if (!(value >= 0 && value <= 1e32))
            fail(description, "R, G and B must be from 0 to 1e32");
        color[glm::length_t(c)] = float(value);
    }
    if (kind.name != "point")
        return make_distant(description, kind, numbers, color);
    for (std::size_t i = 0; i < 3; ++i)
        if (std::abs(numbers[i]) > 1e12)
            fail(description, "the place must be within 1e12 metres of the origin");
    return PointLight{std::string(description), glm::vec3(numbers[0], numbers[1], numbers[2]), color};
}

void add_light(Environment& environment, std::string_view description) {
    const auto light = parse_light(description);
    if (const auto* point = std::get_if<PointLight>(&light))
        environment.point_lights.push_back(*point);
    else
        environment.distant_lights.push_back(std::get<DistantLight>(light));
}

} // namespace kokage
