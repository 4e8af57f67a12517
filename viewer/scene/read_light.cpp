// A scene file's environment, lights and ground.
#include "common/environment/light_description.h"
#include "common/services/number_text.h"
#include "viewer/scene/scene_parts.h"

namespace kokage {
namespace {

constexpr double kMostLight = 1e30;

std::string color_text(const glm::vec3& color) {
    return number_text(double(color.r)) + "," + number_text(double(color.g)) + "," + number_text(double(color.b));
}

/// [azimuth, elevation] in degrees.
std::string angles_text(const JsonReader& json) {
    const std::vector<JsonReader> parts = json.elements(2, 2);
    return number_text(parts[0].number(-360, 360)) + "," + number_text(parts[1].number(-90, 90));
}

/// The one key of `kinds` that is there.
std::string only_kind(const JsonReader& json, std::initializer_list<const char*> kinds) {
    std::string found, list;
    for (const char* kind : kinds) {
        list += (list.empty() ? "" : ", ") + std::string(kind);
        if (!json.find(kind))
            continue;
        if (!found.empty())
            json.fail("'" + found + "' and '" + kind + "' contradict one another; keep one of them");
        found = kind;
    }
    if (found.empty())
        json.fail("it does not say what it is: one of these is missing: " + list);
    return found;
}

void read_sky(const JsonReader& json, Surroundings& surroundings) {
    json.check_keys({"sun", "turbidity"});
    surroundings.environment = "sky";
    if (const auto sun = json.find("sun"))
        surroundings.sun = angles_text(*sun);
    if (const auto turbidity = json.find("turbidity"))
        surroundings.turbidity = turbidity->number(2, 10);
}

void read_image(const JsonReader& json, const JsonReader& name, const SceneFiles& files, SceneDescription& scene) {
    scene.surroundings.environment = files.find(name, {".hdr", ".exr", ".png"}).string();
    if (const auto turn = json.find("turn"))
        scene.environment_turn_degrees = turn->number(-360, 360);
    if (const auto strict = json.find("strict"))
        scene.surroundings.strict = strict->boolean();
}

void read_gradient(const JsonReader& json, Surroundings& surroundings) {
    json.check_keys({"zenith", "horizon", "nadir"});
    surroundings.environment = "gradient:";
    for (const char* part : {"zenith", "horizon", "nadir"})
        surroundings.environment +=
            (part == std::string("zenith") ? "" : ",") + color_text(json.at(part).color(kMostLight));
}

} // namespace

void read_environment(const JsonReader& json, const SceneFiles& files, SceneDescription& scene) {
    if (json.is_string()) {
        if (json.text() == "sky")
            scene.surroundings.environment = "sky";
        else if (json.text() == "constant" || json.text() == "gradient")
            json.fail("'" + json.text() +
                      "' needs its colours: {\"constant\": 1} or {\"gradient\": {\"zenith\": ..., "
                      "\"horizon\": ..., \"nadir\": ...}}");
        else
            read_image(json, json, files, scene);
        return;
    }
    json.check_keys({"sky", "image", "turn", "strict", "constant", "gradient"});
    const std::string kind = only_kind(json, {"sky", "image", "constant", "gradient"});
    for (const char* key : {"turn", "strict"})
        if (kind != "image" && json.find(key))
            json.find(key)->fail("'" + std::string(key) + "' is for images; take it away" +
                                 (kind == "sky" ? " (\"sky\": {\"sun\": [azimuth, elevation]} turns the sky)" : ""));
    const JsonReader value = json.at(kind.c_str());
    if (kind == "sky")
        read_sky(value, scene.surroundings);
    else if (kind == "image")
        read_image(json, value, files, scene);
    else if (kind == "constant")
        scene.surroundings.environment = "constant:" + color_text(value.color(kMostLight));
    else
        read_gradient(value, scene.surroundings);
}

std::string read_light(const JsonReader& json) {
    json.check_keys({"sun", "disc", "directional", "point", "half_angle", "irradiance", "intensity"});
    const std::string kind = only_kind(json, {"sun", "disc", "directional", "point"});
    const bool is_point = kind == "point", is_disc = kind == "disc";
    const char *strength = is_point ? "intensity" : "irradiance", *other = is_point ? "irradiance" : "intensity";
    if (const auto wrong = json.find(other))
        wrong->fail("a light of kind '" + kind + "' has '" + strength + "' in place of '" + other + "'");
    if (const auto angle = json.find("half_angle"); angle && !is_disc)
        angle->fail("'half_angle' is for lights of kind 'disc'; take it away");
    const JsonReader place = json.at(kind.c_str());
    std::string text = kind + ":";
    if (is_point) {
        const glm::dvec3 at = place.vector(-1e6, 1e6);
        text += number_text(at.x) + "," + number_text(at.y) + "," + number_text(at.z);
    } else {
        text += angles_text(place);
    }
    text += "," + color_text(json.at(strength).color(kMostLight));
    if (is_disc)
        text += "," + number_text(json.at("half_angle").number(0.001, 90));
    parse_light(text); // what is written here must read there
    return text;
}

void read_ground(const JsonReader& json, Surroundings& surroundings) {
    if (json.is_boolean()) {
        surroundings.ground = json.boolean();
        return;
    }
    json.check_keys({"albedo"});
    surroundings.ground = true;
    if (const auto albedo = json.find("albedo"))
        surroundings.ground_albedo = color_text(albedo->color());
}

} // namespace kokage
