#include "viewer/scene/surroundings.h"
#include "common/environment/analytic_sky.h"
#include "common/environment/light_description.h"
#include "common/environment/load_environment.h"
#include "common/services/count_text.h"
#include "common/services/error.h"
#include "reflection/maps/map_file.h"
#include "viewer/scene/data_folder.h"
#include "viewer/scene/values.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>

namespace kokage {
namespace {

constexpr float kHighestRadiance = 1e30f;
constexpr glm::vec3 kDryGrass(0.17f, 0.16f, 0.09f);

/// The part behind "constant:" or "gradient:"; false if `text` begins otherwise.
bool split_kind(const std::string& text, const std::string& kind, std::string& values) {
    if (text != kind && text.rfind(kind + ":", 0) != 0)
        return false;
    values = text.size() > kind.size() ? text.substr(kind.size() + 1) : "";
    return true;
}

Daylight daylight(const Surroundings& surroundings) {
    Daylight result;
    if (surroundings.turbidity)
        result.turbidity = *surroundings.turbidity;
    if (surroundings.sun.empty())
        return result;
    const std::vector<double> angles = numbers_from(surroundings.sun, surroundings.words.sun);
    if (angles.size() != 2 || angles[1] < -90 || angles[1] > 90)
        throw InputError(
            surroundings.words.sun + ": '" + surroundings.sun +
            "' is not AZIMUTH,ELEVATION in degrees, such as 135,45 (azimuth 0 is north, -Z; 90 is east, +X)");
    result.sun_azimuth_degrees = angles[0];
    result.sun_elevation_degrees = angles[1];
    return result;
}

Environment gradient(const std::string& values, const std::string& option) {
    if (values.empty())
        return gradient_environment({0.25f, 0.45f, 0.9f}, {0.8f, 0.85f, 0.9f}, {0.12f, 0.1f, 0.08f});
    const std::vector<double> n = numbers_from(values, option + " gradient");
    const bool in_range =
        std::all_of(n.begin(), n.end(), [](double x) { return x >= 0 && x <= double(kHighestRadiance); });
    if (n.size() != 9 || !in_range)
        throw InputError(option + " gradient: '" + values +
                         "' is not nine numbers from 0: red,green,blue of the zenith, of the horizon and of the nadir");
    const auto color = [&](std::size_t i) { return glm::vec3(n[i], n[i + 1], n[i + 2]); };
    return gradient_environment(color(0), color(3), color(6));
}

/// What needs no file, lights left out. Empty for a file.
std::optional<Environment> made_environment(const Surroundings& surroundings) {
    std::string values;
    if (surroundings.environment == "sky")
        return analytic_sky(daylight(surroundings));
    if (split_kind(surroundings.environment, "constant", values))
        return constant_environment(
            values.empty() ? glm::vec3(1.f)
                           : color_from(values, surroundings.words.environment + " constant", kHighestRadiance));
    if (split_kind(surroundings.environment, "gradient", values))
        return gradient(values, surroundings.words.environment);
    return {};
}

/// What messages call lights, asked in the order in which the user gave those of one text.
class LightNames {
  public:
    explicit LightNames(const Surroundings& surroundings) : surroundings_(surroundings) {}

    std::string of(const std::string& text) {
        if (surroundings_.words.lights.empty())
            return "the light '" + text + "'";
        const std::vector<std::string>& lights = surroundings_.lights;
        std::size_t& next = next_[text];
        next = std::size_t(std::find(lights.begin() + std::ptrdiff_t(next), lights.end(), text) - lights.begin()) + 1;
        return surroundings_.words.lights + "/" + std::to_string(next - 1) + ": the light";
    }

  private:
    const Surroundings& surroundings_;
    std::map<std::string, std::size_t> next_; ///< where to look on for lights of a text
};

/// The lowest point of bark within a few radii of a stem's foot, or the foot itself.
float lowest_bark_near(const Tree& tree, const Branch::Node& foot) {
    float lowest = foot.position.y;
    for (const TreePart& part : tree.parts) {
        if (part.kind != TreePartKind::bark)
            continue;
        for (const glm::vec3& position : part.positions)
            if (glm::distance(position, foot.position) <= 3 * foot.radius_m)
                lowest = std::min(lowest, position.y);
    }
    return lowest;
}

} // namespace

float foot_height(const Tree& tree) {
    constexpr float kNone = std::numeric_limits<float>::max();
    float lowest = kNone, thickest = 0;
    for (const Branch& branch : tree.skeleton.branches)
        if (branch.parent < 0)
            thickest = std::max(thickest, branch.nodes.front().radius_m);
    for (const Branch& branch : tree.skeleton.branches) {
        const Branch::Node& foot = branch.nodes.front();
        if (branch.parent >= 0 || foot.radius_m < 0.5f * thickest) // of a bush, the stems
            continue;
        if (tree.branching_known) {
            lowest = std::min(lowest, foot.position.y);
        } else if (thickest >
                   0) { // an inferred axis begins inside of the wood: its lowest bark thereabouts is the foot
            lowest = std::min(lowest, lowest_bark_near(tree, foot));
        }
    }
    if (lowest != kNone)
        return lowest;
    for (const TreePart& part : tree.parts)
        for (const glm::vec3& position : part.positions)
            lowest = std::min(lowest, position.y);
    return lowest == kNone ? 0.f : lowest;
}

void add_light_options(CLI::App& app, Surroundings& s) {
    app.add_option("--sun", s.sun,
                   "Sky: where the sun stands, in degrees (otherwise 135,45); azimuth 0 is north (-Z), 90 east (+X). "
                   "Below the horizon the sky is that of sunset, dimmed: dusk, not a night with stars or moon")
        ->type_name("AZ,EL")
        ->group("Light");
    app.add_option("--turbidity", s.turbidity, "Sky: haze, from 2 (very clear) to 10 (otherwise 3)")
        ->type_name("T")
        ->group("Light");
    app.add_option("--light", s.lights,
                   "A light more (what a ground hides is left out): sun:AZ,EL,R,G,B  disc:AZ,EL,R,G,B,HALF_ANGLE  "
                   "directional:AZ,EL,R,G,B  "
                   "point:X,Y,Z,R,G,B; may be repeated. Angles in degrees, places in metres; R,G,B is the irradiance "
                   "on a surface that faces the light (point: at 1 m). sun is a disc of the sun's size, directional "
                   "has none")
        ->type_name("LIGHT")
        ->allow_extra_args(false)
        ->group("Light");
    app.add_flag("--strict", s.strict, "Images: refuse bad pixels instead of repairing them")->group("Light");
}

void add_surroundings_options(CLI::App& app, Surroundings& s) {
    app.add_option("--environment", s.environment,
                   "What lights the tree: sky (daylight with sun), constant[:R,G,B], gradient[:nine numbers: zenith, "
                   "horizon, nadir], "
                   "or a lat-long image (.hdr, .exr, .png), twice as wide as high")
        ->type_name("ENV")
        ->capture_default_str()
        ->group("Light");
    add_light_options(app, s);
    const auto ground = [&](const char* name, bool value, const char* what) {
        return app
            .add_flag_function(
                name, [&s, value](std::int64_t) { s.ground = value; }, what)
            ->group("Light");
    };
    CLI::Option* with =
        ground("--ground", true, "A diffuse ground under the tree takes part in the light (always so under the sky)");
    ground("--no-ground", false, "No ground, not under the sky either")->excludes(with);
    app.add_option("--ground-albedo", s.ground_albedo,
                   "Its colour: one number or R,G,B from 0 to 1 (otherwise dry grass: 0.17,0.16,0.09)")
        ->type_name("COLOR")
        ->group("Light");
}

void check_surroundings(const Surroundings& s, const std::filesystem::path& data) {
    if (s.environment != "sky" && (!s.sun.empty() || s.turbidity))
        throw InputError("--sun and --turbidity shape the sky; under '" + s.environment +
                         "' add a light: --light sun:AZ,EL,R,G,B");
    if (!s.ground_albedo.empty()) {
        color_from(s.ground_albedo, "--ground-albedo");
        if (s.ground == false)
            throw InputError("--ground-albedo and --no-ground contradict one another; leave one of them out");
    }
    for (const std::string& light : s.lights)
        parse_light(light);
    if (made_environment(s))
        return;
    std::error_code ignored;
    if (std::filesystem::is_directory(s.environment, ignored))
        throw InputError(s.words.environment + ": '" + s.environment +
                         "' is a folder; give an image (.hdr, .exr, .png)");
    if (!std::filesystem::exists(s.environment, ignored))
        throw InputError(s.words.environment + ": there is no file '" + s.environment +
                         "'; give an image (.hdr, .exr, .png), or sky, constant or gradient" +
                         looked_for_in(s.environment, data));
}

bool is_environment_image(const Surroundings& surroundings) {
    return !made_environment(surroundings);
}

Environment obtain_environment(const Surroundings& s, const glm::dvec3& origin, EnvironmentReport& report, bool split,
                               double turn_degrees) {
    std::optional<Environment> made = made_environment(s);
    EnvironmentLoading loading;
    loading.strict = s.strict;
    loading.split = split;
    loading.turn_degrees = turn_degrees;
    if (!made)
        check_is_no_map(s.environment);
    Environment environment = made ? std::move(*made) : load_environment(s.environment, report, loading);
    for (const std::string& light : s.lights)
        add_light(environment, light);
    for (PointLight& light : environment.point_lights)
        light.position = glm::vec3(glm::dvec3(light.position) - origin);
    return environment;
}

std::vector<std::string> drop_hidden_lights(const Surroundings& s, Environment& environment, const Ground& ground) {
    std::vector<std::string> dropped;
    const std::string mend = " (" + s.words.no_ground + " lets light through from below)";
    LightNames names(s);
    std::erase_if(environment.distant_lights, [&](const DistantLight& light) {
        const bool hidden = std::asin(std::clamp(light.direction.y, -1.f, 1.f)) + light.half_angle <= 0;
        if (hidden && light.texels.empty())
            dropped.push_back(names.of(light.name) + " is below the horizon: the ground hides it, and it is left out" +
                              mend);
        return hidden;
    });
    std::erase_if(environment.point_lights, [&](const PointLight& light) {
        const bool hidden = light.position.y < ground.height_m;
        if (hidden)
            dropped.push_back(names.of(light.name) + " is under the ground, which hides it: it is left out" + mend);
        return hidden;
    });
    return dropped;
}

std::string added_lights_text(const Surroundings& s, const Environment& environment) {
    constexpr std::size_t kNamed = 4;
    const auto named = [](const std::string& name) {
        return [&name](const auto& light) { return light.name == name; };
    };
    std::vector<std::string> there;
    for (const std::string& light : s.lights)
        if (std::any_of(environment.distant_lights.begin(), environment.distant_lights.end(), named(light)) ||
            std::any_of(environment.point_lights.begin(), environment.point_lights.end(), named(light)))
            there.push_back(light);
    std::string text = there.empty() ? "" : there.size() == 1 ? ", with the light " : ", with the lights ";
    for (std::size_t i = 0; i < std::min(there.size(), kNamed); ++i)
        text += (i == 0 ? "" : " + ") + there[i];
    return there.size() > kNamed ? text + " and " + count_text(there.size() - kNamed) + " more" : text;
}

std::optional<std::string> night_warning(const Surroundings& s) {
    if (s.environment != "sky" || s.sun.empty() || sun_irradiance(daylight(s)) != glm::vec3(0.f))
        return {};
    return s.words.sun +
           ": the sun is below the horizon and gives no light; there is no night sky (no stars, no moon): what "
           "lights the tree is the sky of sunset, only dimmer, and automatic exposure brightens the picture again "
           "(give " +
           s.words.exposure + " for one that is dark)";
}

std::optional<Ground> obtain_ground(const Surroundings& s, const Environment& environment, const Tree& tree) {
    return obtain_ground(s, environment, foot_height(tree));
}

std::optional<Ground> obtain_ground(const Surroundings& s, const Environment& environment, float height_m) {
    const bool wanted = s.ground.value_or(!environment.has_lower_half || !s.ground_albedo.empty());
    if (!wanted)
        return {};
    Ground ground;
    ground.albedo = kDryGrass;
    if (!s.ground_albedo.empty())
        ground.albedo = color_from(s.ground_albedo, "--ground-albedo");
    ground.height_m = height_m;
    return ground;
}

} // namespace kokage
