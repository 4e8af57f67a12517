#pragma once
// Scenes whose pictures have known answers.
#include "reflection/picture.h"
#include "tests/unit/common/scene_builders.h"

namespace kokage::test {

/// Every side of every patch has one radiance, all of it indirect.
inline ShadedScene evenly_shaded(const PatchScene& patches, const glm::vec3& radiance) {
    ShadedScene scene;
    scene.patches = &patches;
    scene.indirect_front.assign(patches.patches.size(), radiance);
    scene.indirect_back = scene.radiance_front = scene.radiance_back = scene.indirect_front;
    return scene;
}

inline DistantLight disc_light(const glm::vec3& direction, float half_angle, const glm::vec3& irradiance) {
    DistantLight light;
    light.direction = glm::normalize(direction);
    light.half_angle = half_angle;
    light.irradiance = irradiance;
    return light;
}

inline Camera camera_at(const glm::vec3& position, const glm::vec3& target, float field_of_view = 0.6f) {
    Camera camera;
    camera.position = position;
    camera.target = target;
    camera.vertical_field_of_view = field_of_view;
    return camera;
}

/// Shows light as it was solved.
inline PictureOptions small_picture(int width, int height, int samples = 16) {
    PictureOptions options;
    options.width = width;
    options.height = height;
    options.samples = samples;
    options.gather_rays = 0;
    return options;
}

inline PictureOptions without_ground(int width, int height, int samples) {
    PictureOptions options = small_picture(width, height, samples);
    options.ground = PictureGround::none;
    return options;
}

/// Of the columns from `begin` to before `end`.
inline glm::dvec3 mean_of_columns(const Image& image, int begin, int end) {
    glm::dvec3 sum(0.);
    for (int y = 0; y < image.height; ++y)
        for (int x = begin; x < end; ++x)
            sum += glm::dvec3(image.at(x, y)[0], image.at(x, y)[1], image.at(x, y)[2]);
    return sum / (double(end - begin) * image.height);
}

inline glm::dvec3 mean_of(const Image& image) {
    return mean_of_columns(image, 0, image.width);
}

inline glm::vec3 pixel(const Image& image, int x, int y) {
    return {image.at(x, y)[0], image.at(x, y)[1], image.at(x, y)[2]};
}

} // namespace kokage::test
