// A scene file's camera and output.
#include "viewer/scene/scene_parts.h"

namespace kokage {

CameraDescription read_camera(const JsonReader& json) {
    json.check_keys({"position", "target", "azimuth", "field_of_view"});
    constexpr double kFarthest = 1e5, kLeastDistance = 1e-4;
    CameraDescription camera;
    const auto position = json.find("position"), target = json.find("target"), azimuth = json.find("azimuth");
    if (bool(position) != bool(target))
        json.fail(position ? "'position' is given without 'target'; give both, or neither"
                           : "'target' is given without 'position'; give both, or neither");
    if (position && azimuth)
        azimuth->fail("'azimuth' turns the camera that is placed by itself, but 'position' is given; keep one of them");
    if (position) {
        camera.position = position->vector(-kFarthest, kFarthest);
        camera.target = target->vector(-kFarthest, kFarthest);
        if (glm::distance(*camera.position, *camera.target) < kLeastDistance)
            json.fail("'position' and 'target' are the same place; the camera needs a direction");
    }
    if (azimuth)
        camera.azimuth_degrees = azimuth->number(-360, 360);
    if (const auto field = json.find("field_of_view"))
        camera.vertical_field_of_view_degrees = field->number(0.1, 150);
    return camera;
}

void read_output(const JsonReader& json, PictureOptions& picture) {
    json.check_keys({"size", "samples", "exposure", "seed"});
    if (const auto size = json.find("size")) {
        const std::vector<JsonReader> sides = size->elements(2, 2);
        picture.width = sides[0].integer(1, 32768);
        picture.height = sides[1].integer(1, 32768);
    }
    if (const auto samples = json.find("samples"))
        picture.samples = samples->integer(1, 65536);
    if (const auto exposure = json.find("exposure"))
        picture.exposure_stops = float(exposure->number(-100, 100));
    if (const auto seed = json.find("seed"))
        picture.seed = std::uint64_t(seed->integer(0, std::numeric_limits<int>::max()));
}

} // namespace kokage
