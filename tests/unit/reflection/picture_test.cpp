#include "common/environment/load_environment.h"
#include "common/services/error.h"
#include "common/services/parallel.h"
#include "picture_scenes.h"
#include "reflection/backdrop.h"
#include "reflection/picture.h"

#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

using namespace test;

Image render(const ShadedScene& scene, const Environment& environment, const Camera& camera,
             const PictureOptions& options) {
    const RayQueries queries(*scene.patches);
    return render_picture(scene, queries, environment, camera, options, silent_progress()).radiance;
}

void expect_all(const Image& image, const glm::vec3& value, float tolerance) {
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (std::size_t c = 0; c < 3; ++c)
                ASSERT_NEAR(image.at(x, y)[c], value[c], tolerance) << "pixel " << x << ", " << y << " channel " << c;
}

const Optics kBright{glm::vec3(0.6f), glm::vec3(0.4f)};

TEST(Picture, FurnaceOfGreyGroundAndTreeIsEvenEverywhere) {
    PatchScene patches = random_crown(300, 2, kBright);
    patches.ground = Ground{0.f, glm::vec3(1.f)};
    const Image image = render(evenly_shaded(patches, glm::vec3(1.f)), constant_environment(glm::vec3(1.f)),
                               frame_scene(patches, 1.f), small_picture(40, 40));
    expect_all(image, glm::vec3(1.f), 2e-5f);
}

TEST(Picture, FurnaceOnABackdropThatCatchesShadowsIsEvenEverywhere) {
    const PatchScene patches = random_crown(300, 2, kBright);
    const Image image = render(evenly_shaded(patches, glm::vec3(1.f)), constant_environment(glm::vec3(1.f)),
                               frame_scene(patches, 1.f), small_picture(40, 40));
    expect_all(image, glm::vec3(1.f), 2e-5f);
}

TEST(Picture, BackdropDarkensUnderADarkTreeAndNotFarAway) {
    const PatchScene patches = random_crown(2000, 4, Optics{});
    const Camera above = camera_at({0, 60, 0}, {0, 0, 0}, 0.3f);
    PictureOptions options = small_picture(33, 33);
    const Image image =
        render(evenly_shaded(patches, glm::vec3(0.f)), constant_environment(glm::vec3(1.f)), above, options);
    EXPECT_NEAR(pixel(image, 0, 0).g, 1.f, 0.01f);
    options.ground = PictureGround::none;
    const Image without =
        render(evenly_shaded(patches, glm::vec3(0.f)), constant_environment(glm::vec3(1.f)), above, options);
    EXPECT_NEAR(pixel(without, 0, 0).g, 1.f, 1e-5f);
    // Beside the crown, seen past its edge.
    EXPECT_LT(pixel(image, 16, 19).g, 0.97f);
    EXPECT_GT(pixel(without, 16, 19).g, pixel(image, 16, 19).g);
}

TEST(Picture, RootsBelowTheFootAreHiddenByTheGround) {
    PatchScene patches;
    patches.optics = {Optics{}};
    add_rectangle(patches, {-1, -3, 0}, {2, 0, 0}, {0, 4, 0});
    ShadedScene scene = evenly_shaded(patches, {0, 5, 0});
    const Camera camera = camera_at({0, 2, 8}, {0, -0.5f, 0}, 0.05f);
    EXPECT_NEAR(pixel(render(scene, constant_environment({1, 0, 0}), camera, small_picture(3, 3)), 1, 1).g, 5.f, 1e-4f);
    scene.foot_height = 0.f;
    const glm::vec3 hidden = pixel(render(scene, constant_environment({1, 0, 0}), camera, small_picture(3, 3)), 1, 1);
    EXPECT_EQ(hidden.g, 0.f);
    EXPECT_GT(hidden.r, 0.5f);
}

/// Share of a disc (radius 1) beyond a chord at distance s from its centre.
double segment_share(double s) {
    s = std::clamp(s, -1.0, 1.0);
    return (std::acos(s) - s * std::sqrt(1 - s * s)) / kPiDouble;
}

TEST(Picture, ShadowEdgeIsTheAnalyticPenumbra) {
    // A square at height 10 whose edge is at x = 0 hides the half of the sky with x < 0; the sun is overhead.
    PatchScene patches;
    patches.optics = {Optics{}};
    add_rectangle(patches, {-40, 10, -20}, {40, 0, 0}, {0, 0, 40});
    patches.ground = Ground{0.f, glm::vec3(1.f)}; // albedo 1: no variation of the soil
    Environment environment = constant_environment(glm::vec3(0.f));
    const float half_angle = 0.05f;
    environment.distant_lights.push_back(disc_light({0, 1, 0}, half_angle, glm::vec3(kPi)));
    // The camera is under the square and looks straight down at the edge's shadow: 128 pixels across 2 m.
    Camera camera = camera_at({0, 5, 0}, {0, 0, 0}, 2 * std::atan(0.2f));
    camera.up = {0, 0, -1};
    PictureOptions options = small_picture(128, 3, 64);
    options.height = 1;
    camera.vertical_field_of_view = 2 * std::atan(0.2f / 128);
    options.light_samples = 16;
    const Image image = render(evenly_shaded(patches, glm::vec3(0.f)), environment, camera, options);
    for (int x = 0; x < options.width; ++x) {
        const double place = ((x + 0.5) / options.width * 2 - 1) * 0.2 * 5;
        const double lit = segment_share(-place / (10 * std::tan(double(half_angle))));
        EXPECT_NEAR(pixel(image, x, 0).g, lit, 0.012) << "at x = " << place;
    }
}

TEST(Picture, LeafShowsReflectedLightInFrontAndTransmittedLightBehind) {
    PatchScene patches;
    patches.optics = {Optics{{0.1f, 0.3f, 0.05f}, {0.05f, 0.2f, 0.02f}}};
    add_rectangle(patches, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0}); // front: +Z
    Environment environment = constant_environment(glm::vec3(0.f));
    environment.distant_lights.push_back(disc_light({0, 0.6f, 0.8f}, 0.f, glm::vec3(10.f)));
    const ShadedScene scene = evenly_shaded(patches, glm::vec3(0.5f));
    const PictureOptions options = small_picture(3, 3);
    const Image front = render(scene, environment, camera_at({0, 0, 5}, {0, 0, 0}, 0.05f), options);
    const Image back = render(scene, environment, camera_at({0, 0, -5}, {0, 0, 0}, 0.05f), options);
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(pixel(front, 1, 1)[c], 0.5f + patches.optics[0].reflectance[c] * 8 / kPi, 1e-4f);
        EXPECT_NEAR(pixel(back, 1, 1)[c], 0.5f + patches.optics[0].transmittance[c] * 8 / kPi, 1e-4f);
    }
}

TEST(Picture, PointLightFallsOffWithTheSquareOfDistance) {
    PatchScene patches;
    patches.optics = {Optics{glm::vec3(0.5f), glm::vec3(0.f)}};
    add_rectangle(patches, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    Environment environment = constant_environment(glm::vec3(0.f));
    environment.point_lights.push_back({"lamp", {0, 0, 2}, glm::vec3(3.f)});
    const Image image = render(evenly_shaded(patches, glm::vec3(0.f)), environment,
                               camera_at({0, 0, 5}, {0, 0, 0}, 0.01f), small_picture(3, 3));
    EXPECT_NEAR(pixel(image, 1, 1).g, 0.5f / kPi * 3 / 4, 1e-4f);
}

TEST(Picture, HolesOfAnAlphaMaskShowWhatIsBehind) {
    PatchScene patches;
    patches.optics = {Optics{}};
    add_rectangle(patches, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    patches.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
    auto alpha = std::make_shared<Image>(2, 1, 1);
    *alpha->at(1, 0) = 1; // the left half (x < 0) is a hole
    patches.masks.push_back({alpha, 0.5f, TextureWrap::clamp, TextureWrap::clamp});
    patches.triangle_mask = {0, 0};
    const Image image = render(evenly_shaded(patches, {0, 2, 0}), constant_environment({1, 0, 0}),
                               camera_at({0, 0, 5}, {0, 0, 0}, 0.3f), small_picture(16, 16));
    EXPECT_LT(glm::length(pixel(image, 3, 8) - glm::vec3(1, 0, 0)), 1e-5f);
    EXPECT_LT(glm::length(pixel(image, 12, 8) - glm::vec3(0, 2, 0)), 1e-5f);
}

TEST(Picture, TextureVariesRadianceAboutItsMean) {
    PatchScene patches;
    patches.optics = {Optics{}};
    add_rectangle(patches, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    patches.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
    auto texture = std::make_shared<Image>(2, 1, 3);
    texture->pixels = {0.2f, 0.4f, 0.f, 0.6f, 0.4f, 0.f};
    ShadedScene scene = evenly_shaded(patches, glm::vec3(1.f));
    SurfaceLook look;
    look.base_color = glm::vec3(0.5f);
    look.base_color_texture = texture;
    look.mean_base_color = {0.2f, 0.2f, 0.f};
    look.wrap_u = look.wrap_v = TextureWrap::clamp;
    scene.looks = {look};
    scene.triangle_look = {0, 0};
    const Image image = render(scene, constant_environment(glm::vec3(0.f)), camera_at({0, 0, 5}, {0, 0, 0}, 0.3f),
                               small_picture(16, 16));
    EXPECT_NEAR(pixel(image, 1, 8).r, 0.5f, 1e-4f);
    EXPECT_NEAR(pixel(image, 14, 8).r, 1.5f, 1e-4f);
    EXPECT_NEAR(pixel(image, 8, 8).g, 1.f, 1e-4f);
    EXPECT_NEAR(pixel(image, 8, 8).b, 1.f, 1e-4f); // a channel that the mean lacks is left as it was solved
}

TEST(Picture, SmoothSurfacesBlendRadianceAcrossPatches) {
    PatchScene patches;
    patches.optics = {Optics{}};
    add_rectangle(patches, {-2, -1, 0}, {2, 0, 0}, {0, 2, 0});
    add_rectangle(patches, {0, -1, 0}, {2, 0, 0}, {0, 2, 0});
    ShadedScene scene = evenly_shaded(patches, glm::vec3(1.f));
    scene.indirect_front[1] = glm::vec3(3.f);
    scene.looks.resize(1);
    scene.looks[0].smooth_normals = true;
    scene.triangle_look.assign(4, 0);
    scene.normals.assign(patches.positions.size(), glm::vec3(0, 0, 1));
    // 4 m are 64 pixels; neither the corners at x = -2 nor those at x = 2 meet the other patch.
    const Image image = render(scene, constant_environment(glm::vec3(0.f)),
                               camera_at({0, 0, 10}, {0, 0, 0}, 2 * std::atan(0.2f)), small_picture(64, 64, 64));
    EXPECT_NEAR(pixel(image, 32, 32).g, 2.f, 0.05f);
    EXPECT_NEAR(pixel(image, 2, 32).g, 1.f, 0.1f);
    EXPECT_NEAR(pixel(image, 61, 32).g, 3.f, 0.1f);
    for (int x = 3; x < 62; ++x)
        EXPECT_LT(std::abs(pixel(image, x, 32).g - pixel(image, x - 1, 32).g), 0.06f) << "a step at pixel " << x;
}

TEST(Picture, AnEmptySceneIsTheEnvironment) {
    const PatchScene patches;
    Environment environment = constant_environment(glm::vec3(1e30f));
    expect_all(render(evenly_shaded(patches, glm::vec3(0.f)), environment, camera_at({0, 0, 5}, {0, 0, 0}),
                      small_picture(8, 8)),
               glm::vec3(1e30f), 1e25f);
}

TEST(Picture, AnEmptySceneUnderASkyWithoutALowerHalfStandsOnGround) {
    const PatchScene patches;
    Environment environment = constant_environment(glm::vec3(1.f));
    environment.has_lower_half = false;
    const Image image = render(evenly_shaded(patches, glm::vec3(0.f)), environment, camera_at({0, 1, 5}, {0, 0.9f, 0}),
                               small_picture(9, 9));
    EXPECT_NEAR(pixel(image, 4, 0).g, 1.f, 1e-5f);
    EXPECT_NEAR(pixel(image, 4, 8).g, 0.2f, 0.06f);
}

TEST(Picture, DiscLightsAreSeenAtTheirRadiance) {
    const PatchScene patches;
    Environment environment = constant_environment(glm::vec3(0.f));
    environment.distant_lights.push_back(disc_light({0, 0, -1}, 0.1f, glm::vec3(2.f)));
    const Image image = render(evenly_shaded(patches, glm::vec3(0.f)), environment,
                               camera_at({0, 0, 5}, {0, 0, 0}, 0.4f), small_picture(41, 41, 64));
    EXPECT_NEAR(pixel(image, 20, 20).g, 2 / (kPi * std::pow(std::sin(0.1f), 2.f)), 0.01f);
    EXPECT_EQ(pixel(image, 2, 20).g, 0.f);
    // All of it is there: summing the picture's radiance x solid angle gives the irradiance on a plane that faces it.
    double sum = 0;
    const double half = std::tan(0.2);
    for (int y = 0; y < 41; ++y)
        for (int x = 0; x < 41; ++x) {
            const double u = ((x + 0.5) / 41 * 2 - 1) * half, v = ((y + 0.5) / 41 * 2 - 1) * half,
                         r2 = 1 + u * u + v * v;
            sum += double(pixel(image, x, y).g) * std::pow(2 * half / 41, 2) / (r2 * r2);
        }
    EXPECT_NEAR(sum, 2, 0.02);
}

TEST(Picture, BrightRegionsAreSeenWhereTheyWereCutOut) {
    const PatchScene patches;
    Environment environment = constant_environment(glm::vec3(0.f));
    environment.remainder = Image(64, 32, 3);
    DistantLight region;
    const glm::vec3 direction = direction_from_lat_long({40.5f / 64, 12.5f / 32});
    region.direction = direction;
    region.irradiance = glm::vec3(5.f * float(pixel_solid_angle(12, 64, 32)));
    region.texels.push_back({direction, region.irradiance, 0.05f});
    environment.distant_lights.push_back(region);
    const Backdrop backdrop(environment);
    // A cubic B-spline keeps 4/9 of a lone pixel's value at its centre, and all of its energy.
    EXPECT_NEAR(backdrop.seen(direction).g, 5.f * 4 / 9, 0.01f);
    EXPECT_EQ(backdrop.remainder(direction).g, 0.f);
    double sum = 0;
    for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 256; ++x)
            sum +=
                double(backdrop.seen(direction_from_lat_long({(float(x) + 0.5f) / 256, (float(y) + 0.5f) / 128})).g) *
                pixel_solid_angle(y, 256, 128);
    EXPECT_NEAR(sum, double(region.irradiance.g), 0.01 * double(region.irradiance.g));
}

TEST(Picture, LargeLampsAreSeenWholeThoughTheirPixelsAreMerged) {
    Image image(256, 128, 3);
    std::fill(image.pixels.begin(), image.pixels.end(), 0.01f);
    const auto in_lamp = [](int x, int y) { return x >= 100 && x < 130 && y >= 40 && y < 60; };
    for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 256; ++x)
            if (in_lamp(x, y))
                std::fill_n(image.at(x, y), 3, 7.f);
    EnvironmentReport report;
    const Environment environment = environment_from_image(image, "lamp", report);
    ASSERT_EQ(environment.distant_lights.size(), 1u);
    EXPECT_LT(environment.distant_lights[0].texels.size(), 100u);
    const Backdrop backdrop(environment);
    for (int y = 34; y < 66; ++y) // the spline reaches two pixels over the rim
        for (int x = 94; x < 136; ++x)
            if (in_lamp(x - 2, y - 2) && in_lamp(x + 2, y + 2)) {
                const glm::vec2 uv((float(x) + 0.5f) / 256, (float(y) + 0.5f) / 128);
                EXPECT_NEAR(backdrop.seen(direction_from_lat_long(uv)).g, 7.f, 0.01f) << x << ", " << y;
            } else if (!in_lamp(x - 2, y - 2) && !in_lamp(x + 2, y + 2) && !in_lamp(x - 2, y + 2) &&
                       !in_lamp(x + 2, y - 2)) {
                const glm::vec2 uv((float(x) + 0.5f) / 256, (float(y) + 0.5f) / 128);
                EXPECT_NEAR(backdrop.seen(direction_from_lat_long(uv)).g, 0.01f, 1e-4f) << x << ", " << y;
            }
}

TEST(Picture, IsTheSameForAnyNumberOfThreads) {
    PatchScene patches = random_crown(500, 2, kBright);
    patches.ground = Ground{0.f, glm::vec3(0.3f)};
    Environment environment = constant_environment(glm::vec3(0.5f));
    for (int k = 0; k < 5; ++k)
        environment.distant_lights.push_back(disc_light({std::sin(k), 1, std::cos(k)}, 0.02f, glm::vec3(float(k + 1))));
    const ShadedScene scene = evenly_shaded(patches, glm::vec3(0.1f));
    const Camera camera = frame_scene(patches, 1.f);
    set_thread_count(1);
    const Image one = render(scene, environment, camera, small_picture(48, 48, 4));
    set_thread_count(7);
    const Image seven = render(scene, environment, camera, small_picture(48, 48, 4));
    set_thread_count(0);
    EXPECT_EQ(one.pixels, seven.pixels);
}

TEST(Picture, LooksTheSameAtEverySize) {
    auto picture_at = [](float size) {
        PatchScene patches = random_crown(300, 2, kBright);
        for (glm::vec3& position : patches.positions)
            position *= size;
        patches.ground = Ground{0.f, glm::vec3(0.3f)};
        Environment environment = constant_environment(glm::vec3(0.5f));
        environment.distant_lights.push_back(disc_light({1, 1, 1}, 0.005f, glm::vec3(4.f)));
        return render(evenly_shaded(patches, glm::vec3(0.1f)), environment, frame_scene(patches, 1.f),
                      small_picture(32, 32, 16));
    };
    const Image usual = picture_at(1);
    for (float size : {1e-6f, 1e6f}) {
        const Image other = picture_at(size);
        double difference = 0;
        for (std::size_t i = 0; i < usual.pixels.size(); ++i) {
            ASSERT_TRUE(std::isfinite(other.pixels[i]));
            difference += std::abs(double(usual.pixels[i]) - double(other.pixels[i])) / double(usual.pixels.size());
        }
        EXPECT_LT(difference, 0.01) << "at size " << size;
    }
}

TEST(Picture, StaysFiniteInsideTheCrownUnderHugeLights) {
    PatchScene patches = random_crown(500, 3, kBright);
    patches.ground = Ground{0.f, glm::vec3(0.3f)};
    Environment environment = constant_environment(glm::vec3(1e30f));
    environment.distant_lights.push_back(disc_light({0, 1, 0}, 1e-4f, glm::vec3(1e30f)));
    environment.point_lights.push_back({"lamp", patches.positions[0], glm::vec3(1e30f)});
    for (const glm::vec3& place : {glm::vec3(0, 2, 0), glm::vec3(0, -1, 0), patches.positions[0]}) {
        const Image image = render(evenly_shaded(patches, glm::vec3(1e30f)), environment,
                                   camera_at(place, place + glm::vec3(0, 0.3f, 1), 2.f), small_picture(24, 24, 4));
        for (float value : image.pixels)
            ASSERT_TRUE(std::isfinite(value) && value >= 0);
    }
}

TEST(Picture, RefusesWhatItCannotDraw) {
    const PatchScene patches = random_crown(10, 2, kBright);
    const Environment environment = constant_environment(glm::vec3(1.f));
    ShadedScene scene = evenly_shaded(patches, glm::vec3(1.f));
    const Camera camera = frame_scene(patches, 1.f);
    EXPECT_THROW(render(scene, environment, camera, small_picture(0, 8)), InputError);
    EXPECT_THROW(render(scene, environment, camera, small_picture(8, 8, 0)), InputError);
    EXPECT_THROW(render(scene, environment, camera_at({0, 0, 0}, {0, 0, 0}), small_picture(8, 8)), InputError);
    EXPECT_THROW(render(scene, Environment{}, camera, small_picture(8, 8)), InputError);
    scene.indirect_back.pop_back();
    EXPECT_THROW(render(scene, environment, camera, small_picture(8, 8)), InputError);
}

} // namespace
} // namespace kokage
