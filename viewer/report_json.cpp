#include "viewer/report_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace kokage {
using Json = nlohmann::ordered_json;

Json number_json(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json vector_json(const glm::vec3& value) {
    return Json::array({number_json(double(value.r)), number_json(double(value.g)), number_json(double(value.b))});
}

Json pairs_json(const std::vector<std::pair<std::string, std::string>>& list) {
    Json json = Json::object();
    for (const auto& [name, value] : list) {
        if (!json.contains(name))
            json[name] = value;
        else if (json[name].is_array())
            json[name].push_back(value);
        else
            json[name] = Json::array({json[name], value});
    }
    return json;
}

Json environment_json(const Environment& environment, const EnvironmentReport& report) {
    Json lights = Json::array();
    for (const DistantLight& light : environment.distant_lights)
        lights.push_back({{"name", light.name},
                          {"direction", vector_json(light.direction)},
                          {"half_angle", number_json(double(light.half_angle))},
                          {"irradiance", vector_json(light.irradiance)}});
    for (const PointLight& light : environment.point_lights)
        lights.push_back({{"name", light.name},
                          {"position", vector_json(light.position)},
                          {"intensity", vector_json(light.intensity)}});
    Json json = {
        {"description", environment.description},
        {"bad_pixels",
         {{"nan", report.nan_pixels}, {"infinite", report.infinite_pixels}, {"negative", report.negative_pixels}}},
        {"bright_regions_found", report.regions_found},
        {"energy_before", number_json(report.energy_before)},
        {"energy_after", number_json(report.energy_after)},
        {"lights", std::move(lights)}};
    if (report.first_bad_x >= 0)
        json["bad_pixels"]["first"] = {report.first_bad_x, report.first_bad_y};
    if (!report.note.empty())
        json["note"] = report.note;
    return json;
}

Json stages_json(const WorkReport& report) {
    Json json = Json::array();
    for (const WorkReport::Stage& stage : report.stages)
        json.push_back({{"name", stage.name},
                        {"cpu_seconds", number_json(stage.cpu_seconds)},
                        {"wall_seconds", number_json(stage.wall_seconds)}});
    return json;
}

Json skips_json(const WorkReport& report) {
    Json json = Json::array();
    for (const WorkReport::Skip& skip : report.skips)
        json.push_back({{"what", skip.what}, {"why", skip.why}, {"would_have_cost", skip.saved}});
    return json;
}

} // namespace kokage
