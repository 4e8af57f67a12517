#include "picture_scenes.h"

#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

using namespace test;

/// Place in the frame, -1 … 1 from left to right and bottom to top.
glm::dvec2 place_in_frame(const Camera& camera, const glm::vec3& point, double aspect) {
    const glm::dvec3 forward = glm::normalize(glm::dvec3(camera.target) - glm::dvec3(camera.position));
    const glm::dvec3 side = glm::normalize(glm::cross(forward, glm::dvec3(camera.up))), up = glm::cross(side, forward);
    const glm::dvec3 offset = glm::dvec3(point) - glm::dvec3(camera.position);
    const double depth = glm::dot(offset, forward), tangent = std::tan(0.5 * double(camera.vertical_field_of_view));
    EXPECT_GT(depth, 0);
    return {glm::dot(offset, side) / depth / tangent / aspect, glm::dot(offset, up) / depth / tangent};
}

TEST(FrameScene, ShowsAllOfABoxAndFillsTheFrame) {
    for (float size : {1e-6f, 1.f, 1e6f})
        for (const glm::vec3& shape : {glm::vec3(1, 1, 1), glm::vec3(0.1f, 1, 0.1f), glm::vec3(5, 0.2f, 5),
                                       glm::vec3(0, 1, 0), glm::vec3(1, 0, 0)})
            for (float aspect : {0.5f, 1.f, 2.f})
                for (float azimuth : {0.f, 0.35f, 3.f}) {
                    const Bounds bounds{size * glm::vec3(3, 0, -2), size * (glm::vec3(3, 0, -2) + shape)};
                    const Camera camera = frame_scene(bounds, aspect, azimuth);
                    double largest = 0;
                    for (unsigned k = 0; k < 8; ++k) {
                        const glm::vec3 corner(k & 1 ? bounds.high.x : bounds.low.x,
                                               k & 2 ? bounds.high.y : bounds.low.y,
                                               k & 4 ? bounds.high.z : bounds.low.z);
                        const glm::dvec2 place = glm::abs(place_in_frame(camera, corner, double(aspect)));
                        EXPECT_LT(std::max(place.x, place.y), 0.9) << "size " << size << " aspect " << aspect;
                        largest = std::max({largest, place.x, place.y});
                    }
                    EXPECT_GT(largest, 0.65) << "the frame is mostly empty";
                    EXPECT_GT(camera.position.y, bounds.low.y);
                }
}

TEST(FrameScene, ShowsEveryCornerOfACrown) {
    const PatchScene patches = random_crown(2000, 3, Optics{});
    const Camera camera = frame_scene(patches, 4.f / 3);
    for (const glm::vec3& position : patches.positions) {
        const glm::dvec2 place = glm::abs(place_in_frame(camera, position, 4.0 / 3));
        EXPECT_LT(std::max(place.x, place.y), 0.9);
    }
}

TEST(FrameScene, NothingAndNonsenseGiveAFiniteCamera) {
    const float nan = std::nanf("");
    for (const Camera& camera : {frame_scene(Bounds{}, 1.f), frame_scene(PatchScene{}, 1.f),
                                 frame_scene(Bounds{glm::vec3(nan), glm::vec3(nan)}, nan)}) {
        EXPECT_TRUE(std::isfinite(glm::length(camera.position)));
        EXPECT_GT(glm::length(camera.target - camera.position), 0.1f);
    }
}

TEST(PhotographersAzimuth, StandsWithTheLightFromTheSide) {
    Environment environment = constant_environment(glm::vec3(1.f));
    const float without = photographers_azimuth(environment);
    EXPECT_TRUE(std::isfinite(without));
    environment.distant_lights.push_back(disc_light({1, 1, 0}, 0.01f, glm::vec3(1.f)));
    environment.distant_lights.push_back(disc_light({0, 1, 1}, 0.01f, glm::vec3(5.f)));
    environment.distant_lights.push_back(disc_light({0, -1, 0.1f}, 0.01f, glm::vec3(50.f)));
    const float azimuth = photographers_azimuth(environment);
    const float cosine = std::cos(azimuth - std::atan2(0.f, 1.f)); // between the camera and the light at +Z
    EXPECT_LT(cosine, 0.8f);
    EXPECT_GT(cosine, 0.f);
}

} // namespace
} // namespace kokage
