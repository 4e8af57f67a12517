// Pictures of glossy objects: the sum over every pixel with the horizon, against the formula in plain loops.
#include "common/environment/lat_long.h"
#include "common/services/error.h"
#include "common/services/parallel.h"
#include "common/services/random.h"
#include "reflection/maps/brute_force_baker.h"
#include "reflection/maps/glossy_picture.h"

#include <cmath>
#include <gtest/gtest.h>

using namespace kokage;

namespace {

Image noise_picture(int width, int height) {
    Image image(width, height, 3);
    Random random(3);
    for (float& value : image.pixels)
        value = random.uniform();
    return image;
}

/// A ball of radius 1 at the origin.
MeshScene ball(int rows) {
    SceneMesh mesh;
    for (int y = 0; y <= rows; ++y)
        for (int x = 0; x <= 2 * rows; ++x) {
            const float theta = kPi * float(y) / float(rows), phi = kPi * float(x) / float(rows);
            mesh.positions.emplace_back(std::sin(theta) * std::cos(phi), std::cos(theta),
                                        -std::sin(theta) * std::sin(phi));
        }
    mesh.normals = mesh.positions;
    const unsigned across = unsigned(2 * rows + 1);
    for (unsigned y = 0; y < unsigned(rows); ++y)
        for (unsigned x = 0; x + 1 < across; ++x) {
            const unsigned a = y * across + x, b = a + across;
            mesh.triangles.push_back({a, b, b + 1});
            mesh.triangles.push_back({a, b + 1, a + 1});
        }
    MeshScene scene;
    scene.meshes.push_back(mesh);
    return scene;
}

Camera camera_before_ball() {
    Camera camera;
    camera.position = {0, 0, 5};
    return camera;
}

TEST(GlossyPicture, MirrorsTheViewOnABall) {
    const GlossyObject object = glossy_object(ball(64), false);
    const SurfacePixels pixels = surface_in_view(object, camera_before_ball(), 61, 41);
    ASSERT_GT(pixels.size(), 100u);
    const double tangent = std::tan(0.3);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        // The ray through the pixel's centre, and the ball's nearer point on it.
        const double x = (int(pixels.pixel[i] % 61) - 30) / 20.5 * tangent,
                     y = -(int(pixels.pixel[i] / 61) - 20) / 20.5 * tangent;
        const glm::dvec3 ray = glm::normalize(glm::dvec3(x, y, -1)), eye(0, 0, 5);
        const double b = glm::dot(ray, eye), under_root = b * b - 24;
        ASSERT_GE(under_root, -0.1);
        if (under_root < 0.05)
            continue; // the rim, where the ball is not round enough
        const glm::dvec3 normal = eye + (-b - std::sqrt(under_root)) * ray;
        EXPECT_LT(glm::length(glm::dvec3(pixels.normal[i]) - normal), 0.02);
        EXPECT_LT(glm::length(glm::dvec3(pixels.mirrored[i]) - (ray - 2 * glm::dot(normal, ray) * normal)), 0.04);
        EXPECT_LT(glm::length(pixels.position[i] - pixels.normal[i]), 0.01f);
    }
}

TEST(GlossyPicture, TurnsZUpAndRefusesNothing) {
    MeshScene scene = ball(4);
    scene.meshes[0].positions[0] = {1, 2, 3};
    EXPECT_EQ(glossy_object(scene, true).patches.positions[0], glm::vec3(1, 3, -2));
    EXPECT_EQ(glossy_object(scene, false).patches.positions[0], glm::vec3(1, 2, 3));
    EXPECT_THROW(glossy_object(MeshScene(), false), InputError);
}

SurfacePixels scattered_pixels(std::size_t count) {
    SurfacePixels pixels;
    Random random(5);
    const auto direction = [&] {
        const float y = random.uniform(-1, 1), phi = random.uniform(0, 2 * kPi);
        return glm::vec3(std::sqrt(1 - y * y) * std::cos(phi), y, std::sqrt(1 - y * y) * std::sin(phi));
    };
    for (std::size_t i = 0; i < count; ++i) {
        pixels.pixel.push_back(std::uint32_t(i));
        pixels.normal.push_back(direction());
        pixels.mirrored.push_back(glm::normalize(direction() + 0.7f * pixels.normal.back()));
    }
    return pixels;
}

TEST(GlossyPicture, BruteForceIsTheFormula) {
    // Eqs 1 and 2 over every pixel cut into 16 x 16 points, divided by the full mass 2 pi/(L+1).
    const Image image = noise_picture(24, 12);
    const SurfacePixels pixels = scattered_pixels(12);
    for (double exponent : {1.0, 6.0, 25.0}) {
        const std::vector<float> parameters(pixels.size(), float(exponent));
        const auto values = reflected_by_brute_force(pixels, LobeKind::phong, parameters, image);
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            glm::dvec3 sum(0.0);
            for (int y = 0; y < 12 * 16; ++y)
                for (int x = 0; x < 24 * 16; ++x) {
                    const glm::dvec3 light = pixel_direction(x, y, 24 * 16, 12 * 16);
                    if (glm::dot(light, glm::dvec3(pixels.normal[i])) < 0)
                        continue;
                    // The lobe is taken at the pixel's centre, as the map's is.
                    const glm::dvec3 centre = pixel_direction(x / 16, y / 16, 24, 12);
                    const double cosine = glm::dot(centre, glm::dvec3(pixels.mirrored[i]));
                    if (cosine > 0)
                        sum += std::pow(cosine, exponent) * pixel_solid_angle(y, 24 * 16, 12 * 16) *
                               glm::dvec3(image.at(x / 16, y / 16)[0], image.at(x / 16, y / 16)[1],
                                          image.at(x / 16, y / 16)[2]);
                }
            sum *= (exponent + 1) / (2 * kPiDouble);
            for (int c = 0; c < 3; ++c) // 24 x 12 is coarse: the full mass differs by some 1e-3 where L is large
                EXPECT_NEAR(double(values[i][c]), sum[c], 0.004) << exponent << " pixel " << i;
        }
    }
}

TEST(GlossyPicture, AboveTheHorizonAloneIsTheWholeLobe) {
    // Pixels whose lobe ends above the horizon: with and without it the same.
    const Image image = noise_picture(64, 32);
    Environment environment;
    environment.remainder = image;
    SurfacePixels pixels = scattered_pixels(20);
    pixels.mirrored = pixels.normal;
    for (const LobeKind kind : {LobeKind::phong, LobeKind::ggx}) {
        const std::vector<float> parameters(pixels.size(), kind == LobeKind::phong ? 300.f : 1.f);
        const auto values = reflected_by_brute_force(pixels, kind, parameters, image);
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            const glm::dvec3 whole = filtered_by_brute_force(environment, {kind, double(parameters[i])},
                                                             glm::normalize(glm::dvec3(pixels.mirrored[i])));
            for (int c = 0; c < 3; ++c) // GGX at roughness 1 reaches the horizon, with next to no weight
                EXPECT_NEAR(double(values[i][c]), whole[c], kind == LobeKind::phong ? 1e-6 : 2e-3);
        }
    }
}

TEST(GlossyPicture, MapAndBruteForceAgreeInAFurnace) {
    Image white(256, 128, 3);
    white.pixels.assign(white.pixels.size(), 1.f);
    const SurfacePixels pixels = scattered_pixels(200);
    for (const LobeKind kind : {LobeKind::phong, LobeKind::ggx}) {
        std::vector<float> parameters;
        Random random(8);
        for (std::size_t i = 0; i < pixels.size(); ++i)
            parameters.push_back(kind == LobeKind::phong ? random.uniform(0.5f, 60) : random.uniform(0.3f, 1));
        const auto exact = reflected_by_brute_force(pixels, kind, parameters, white);
        const auto from_map = reflected_from_map(
            pixels, parameters, [](const glm::vec3&, float) { return glm::vec3(1.f); }, HorizonTable(kind));
        for (std::size_t i = 0; i < pixels.size(); ++i)
            EXPECT_NEAR(from_map[i].x, exact[i].x, 4e-3) << parameters[i]; // the share alone
    }
}

TEST(GlossyPicture, SameBitsWithAnyThreads) {
    const Image image = noise_picture(64, 32);
    const SurfacePixels pixels = scattered_pixels(300);
    const std::vector<float> parameters(pixels.size(), 20.f);
    set_thread_count(1);
    const auto one = reflected_by_brute_force(pixels, LobeKind::phong, parameters, image);
    set_thread_count(3);
    const auto three = reflected_by_brute_force(pixels, LobeKind::phong, parameters, image);
    set_thread_count(0);
    EXPECT_EQ(one, three);
}

TEST(GlossyPicture, PutsValuesWhereTheSurfaceIs) {
    const GlossyObject object = glossy_object(ball(8), false);
    const SurfacePixels pixels = surface_in_view(object, camera_before_ball(), 20, 10);
    const std::vector<glm::vec3> red(pixels.size(), glm::vec3(1, 0, 0));
    const Image image = picture_of(pixels, red, {0, 0, 1});
    std::size_t covered = 0;
    for (std::size_t i = 0; i < 200; ++i)
        covered += image.pixels[3 * i] == 1;
    EXPECT_EQ(covered, pixels.size());
    EXPECT_EQ(image.at(0, 0)[2], 1);
    EXPECT_EQ(image.at(10, 5)[0], 1);
    std::vector<float> heights; // linear over triangles: heights of vertices are heights of points
    for (const glm::vec3& position : object.patches.positions)
        heights.push_back(position.y);
    const auto at = interpolated<float>(object, pixels, heights);
    for (std::size_t i = 0; i < at.size(); ++i)
        EXPECT_NEAR(at[i], pixels.position[i].y, 1e-5);
}

} // namespace
