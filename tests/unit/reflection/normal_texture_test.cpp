// Which way a texture of normals turns what is seen.
#include "reflection/surface_points.h"
#include "tests/unit/reflection/picture_scenes.h"

#include <cmath>
#include <gtest/gtest.h>

namespace kokage::test {
namespace {

/// 2 x 2 m on the ground, whose texture has one normal; u runs along +X, v along -Z.
class EvenNormals : public testing::Test {
  protected:
    void make(const glm::vec3& local, float mirrored_u = 1) {
        patches_ = {};
        patches_.optics.resize(1);
        add_rectangle(patches_, {-1, 0, 1}, {2, 0, 0}, {0, 0, -2});
        patches_.uvs = {{0, 0}, {mirrored_u, 0}, {mirrored_u, 1}, {0, 0}, {mirrored_u, 1}, {0, 1}};
        scene_ = evenly_shaded(patches_, glm::vec3(1.f));
        auto image = std::make_shared<Image>(1, 1, 3);
        for (std::size_t c = 0; c < 3; ++c)
            image->pixels[c] = 0.5f + 0.5f * local[c];
        scene_.looks.resize(1);
        scene_.looks[0].normal_texture = image;
        scene_.triangle_look.assign(patches_.triangles.size(), 0);
    }
    glm::vec3 normal(const glm::vec3& origin, const glm::vec3& direction) const {
        const RayQueries queries(patches_);
        const glm::vec3 unit = glm::normalize(direction);
        RayHit hit;
        EXPECT_TRUE(queries.first_hit(origin, unit, 0, 100, hit));
        return SurfacePoints(scene_).at(origin, unit, hit).normal;
    }
    glm::vec3 from_above() const { return normal({0.1f, 2, 0.2f}, {0, -1, 0}); }

    PatchScene patches_;
    ShadedScene scene_;
};

void expect_near(const glm::vec3& a, const glm::vec3& b) {
    EXPECT_LT(glm::distance(a, b), 1e-5f) << a.x << ' ' << a.y << ' ' << a.z;
}

TEST_F(EvenNormals, RedLeansTowardsLargerUAndGreenTowardsSmallerV) {
    make({0, 0, 1});
    expect_near(from_above(), {0, 1, 0});
    make({0.6f, 0, 0.8f});
    expect_near(from_above(), {0.6f, 0.8f, 0});
    make({0, 0.6f, 0.8f});
    expect_near(from_above(), {0, 0.8f, 0.6f});
}

TEST_F(EvenNormals, MirroredTextureLeansTheOtherWay) {
    make({0.6f, 0, 0.8f}, -1);
    expect_near(from_above(), {-0.6f, 0.8f, 0});
    make({0, 0.6f, 0.8f}, -1);
    expect_near(from_above(), {0, 0.8f, 0.6f});
}

TEST_F(EvenNormals, TheBackIsTheFrontTurnedAbout) {
    make({0.6f, 0, 0.8f});
    expect_near(normal({0, -2, 0}, {0, 1, 0}), {-0.6f, -0.8f, 0});
}

TEST_F(EvenNormals, TheScaleIsOfTheirSlope) {
    make({0.6f, 0, 0.8f});
    scene_.looks[0].normal_scale = 2;
    expect_near(from_above(), glm::normalize(glm::vec3(1.2f, 0.8f, 0)));
}

TEST_F(EvenNormals, NeverFaceAwayFromTheViewer) {
    make({0.6f, 0, 0.8f});
    const glm::vec3 direction = glm::normalize(glm::vec3(1, -0.1f, 0)), seen = normal({-0.9f, 0.1f, 0}, direction);
    EXPECT_NEAR(glm::length(seen), 1, 1e-5f);
    EXPECT_GT(-glm::dot(seen, direction), 0);
    EXPECT_LT(-glm::dot(seen, direction), 0.05f);
}

TEST_F(EvenNormals, WhatHasNoSizeInTextureOrFacesDownLeavesTheNormal) {
    make({0.6f, 0, -0.8f});
    expect_near(from_above(), {0, 1, 0});
    make({0.6f, 0, 0.8f});
    patches_.uvs.assign(patches_.uvs.size(), glm::vec2(0.3f));
    expect_near(from_above(), {0, 1, 0});
}

TEST_F(EvenNormals, ALampLightsBySlope) {
    make({0.6f, 0, 0.8f});
    patches_.optics[0].reflectance = glm::vec3(0.5f);
    scene_ = [&] {
        ShadedScene dark = evenly_shaded(patches_, glm::vec3(0.f));
        dark.looks = scene_.looks;
        dark.triangle_look = scene_.triangle_look;
        return dark;
    }();
    Environment light = constant_environment(glm::vec3(0.f));
    light.distant_lights.push_back(disc_light({1, 1, 0}, 0.001f, glm::vec3(1.f)));
    const RayQueries queries(patches_);
    const Image picture = render_picture(scene_, queries, light, camera_at({0, 3, 0.01f}, {0, 0, 0}, 0.1f),
                                         without_ground(4, 4, 4), silent_progress())
                              .radiance;
    EXPECT_NEAR(pixel(picture, 2, 2).g, 0.5f / kPi * 1.4f * std::sqrt(0.5f), 1e-4f);
}

} // namespace
} // namespace kokage::test
