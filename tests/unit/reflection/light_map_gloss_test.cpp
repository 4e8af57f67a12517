#include "common/directions/sphere_sets.h"
#include "common/directions/spherical_harmonics.h"
#include "common/services/error.h"
#include "common/services/random.h"
#include "reflection/light_map_gloss.h"
#include "reflection/light_map_readers.h"
#include "reflection/path_traced_picture.h"
#include "tests/unit/reflection/picture_scenes.h"

#include <cmath>
#include <gtest/gtest.h>

namespace kokage::test {
namespace {

Progress quiet_gloss;

/// Light that varies over the sphere, nowhere negative.
LightMap patchy_map(std::uint64_t seed) {
    LightMap map;
    map.coefficients.assign(sh_count(map.bands), glm::vec3(0.f));
    map.coefficients[0] = glm::vec3(4, 5, 6);
    Random random(seed);
    for (std::size_t j = 1; j < map.coefficients.size(); ++j)
        for (std::size_t c = 0; c < 3; ++c)
            map.coefficients[j][c] = random.uniform(-0.15f, 0.15f);
    return map;
}

LightMap even_map(float radiance) {
    LightMap map;
    map.coefficients.assign(sh_count(map.bands), glm::vec3(0.f));
    map.coefficients[0] = glm::vec3(radiance * 2 * std::sqrt(kPi));
    return map;
}

/// Bark in two plates side by side, level, the left one from x = -1 to 0; each has a map of its own.
struct Plates {
    PatchScene patches;
    ShadedScene scene;
    Environment sky = constant_environment(glm::vec3(1.f));

    explicit Plates(float roughness = 0.8f, const LightMap& left = patchy_map(1),
                    const LightMap& right = patchy_map(2)) {
        patches.optics = {{glm::vec3(0.1f), glm::vec3(0.f)}};
        add_rectangle(patches, {-1, 0, 1}, {1, 0, 0}, {0, 0, -2});
        add_rectangle(patches, {0, 0, 1}, {1, 0, 0}, {0, 0, -2});
        for (Patch& patch : patches.patches)
            patch.kind = PatchKind::bark;
        patches.leaf_count = 0;
        scene = evenly_shaded(patches, glm::vec3(0.1f));
        scene.normals.assign(patches.positions.size(), glm::vec3(0, 1, 0));
        scene.looks.resize(1);
        scene.looks[0].smooth_normals = true;
        scene.looks[0].gloss.normal_reflectance = glm::vec3(0.3f);
        scene.looks[0].gloss.roughness = roughness;
        scene.triangle_look.assign(patches.triangles.size(), 0);
        scene.light_maps.maps = {left, right};
        scene.light_maps.per_patch = 1;
        scene.light_maps.shares = {{0, 1}, {1, 1}};
    }
};

/// What reads the plates' maps, and a point on them.
struct Reading {
    RayQueries queries;
    LightChoice lights;
    SurfaceShading surfaces;
    LightMapGloss gloss;

    explicit Reading(const Plates& plates)
        : queries(plates.patches), lights(plates.sky, 1), surfaces(plates.scene, queries, lights, true),
          gloss(plates.scene, plates.sky, surfaces) {}
    SurfacePoint at(float x, float z = 0) const {
        const glm::vec3 from(x, 2, z), down(0, -1, 0);
        RayHit hit;
        EXPECT_TRUE(queries.first_hit(from, down, 0, 10, hit));
        return surfaces.point(from, down, hit);
    }
};

glm::vec3 radiance_of(const LightMap& map, const glm::vec3& direction) {
    return sh_radiance(map.coefficients, direction);
}

/// The sum that the map's reading stands for.
glm::dvec3 clipped_lobe(const LightMap& map, const glm::vec3& normal, const glm::vec3& mirrored, double roughness) {
    const std::vector<glm::dvec3> directions = fibonacci_sphere(40000).directions;
    glm::dvec3 sum(0.);
    for (const glm::dvec3& direction : directions)
        if (glm::dot(direction, glm::dvec3(normal)) > 0) {
            const glm::dvec3 apart = direction - glm::dvec3(mirrored);
            sum += lobe_value({LobeKind::ggx, roughness}, glm::dot(apart, apart)) *
                   glm::dvec3(radiance_of(map, glm::vec3(direction)));
        }
    return sum * (4 * kPiDouble / double(directions.size()));
}

TEST(LightMapGloss, IsTheMapThroughTheLobeAboveTheHorizon) {
    const LightMap map = patchy_map(1);
    for (const float roughness : {0.7f, 0.8f, 0.95f}) {
        const Plates plates(roughness, map, map);
        const Reading reading(plates);
        const SurfacePoint at = reading.at(-0.5f);
        ASSERT_TRUE(reading.gloss.lights(at));
        for (const float away : {0.f, 0.6f, 1.1f, 1.4f}) {
            SCOPED_TRACE(testing::Message() << roughness << ' ' << away);
            const glm::vec3 mirrored(std::sin(away) * 0.6f, std::cos(away), std::sin(away) * 0.8f);
            const glm::dvec3 truth = clipped_lobe(map, {0, 1, 0}, mirrored, double(roughness));
            const glm::vec3 found = reading.gloss.radiance(at, mirrored);
            // Above the horizon the lobe is whole; clipped, a narrower whole one stands for it.
            const double tolerance = away == 0 ? 0.003 : 0.05;
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(double(found[c]) / truth[c], 1, tolerance) << c;
        }
    }
}

TEST(LightMapGloss, BlendsFromPatchToPatch) {
    const Plates plates(0.8f, even_map(1), even_map(3));
    const Reading reading(plates);
    const glm::vec3 up(0, 1, 0);
    EXPECT_NEAR(reading.gloss.radiance(reading.at(-0.999f, 0.3f), up).g, 1, 0.01);
    EXPECT_NEAR(reading.gloss.radiance(reading.at(0.999f, 0.3f), up).g, 3, 0.01);
    const float left = reading.gloss.radiance(reading.at(-0.001f), up).g,
                right = reading.gloss.radiance(reading.at(0.001f), up).g;
    EXPECT_NEAR(left, right, 0.01f);
    EXPECT_NEAR(left, 2, 0.35);
}

TEST(LightMapGloss, LightsWhatIsRoughAndHasMaps) {
    const Plates rough;
    const Reading reading(rough);
    SurfacePoint at = reading.at(-0.5f);
    EXPECT_TRUE(reading.gloss.lights(at));
    at.roughness = kLeastMapRoughness - 0.01f;
    EXPECT_FALSE(reading.gloss.lights(at));
    at = reading.at(-0.5f);
    at.front = false;
    EXPECT_FALSE(reading.gloss.lights(at));

    Plates one;
    one.scene.light_maps.shares[1].share = 0;
    const Reading half(one);
    EXPECT_TRUE(half.gloss.lights(half.at(-0.5f)));
    EXPECT_FALSE(half.gloss.lights(half.at(0.5f)));

    Plates none;
    none.scene.light_maps = {};
    const Reading empty(none);
    EXPECT_FALSE(empty.gloss.lights(empty.at(-0.5f)));

    // Lobes of middling roughness find so wide a light by their rays.
    Plates lamp(0.72f);
    lamp.sky.distant_lights.push_back(disc_light({0, 1, 0}, 1.2f, glm::vec3(1.f)));
    const Reading lit(lamp);
    EXPECT_FALSE(lit.gloss.lights(lit.at(-0.5f)));
    EXPECT_GT(least_map_roughness(lamp.sky), 0.72f);
}

TEST(LightMapGloss, RefusesMapsThatDoNotFit) {
    for (const int fault : {0, 1, 2}) {
        Plates plates;
        LightMapsOfPatches& maps = plates.scene.light_maps;
        if (fault == 0)
            maps.shares.pop_back();
        else if (fault == 1)
            maps.shares[0].map = 2;
        else
            maps.maps[1].coefficients.pop_back();
        EXPECT_THROW(Reading{plates}, InputError) << fault;
    }
}

TEST(LightMapReaders, AreWhatTheCameraMaySeeOfRoughGloss) {
    // Spheres about triangles are judged: the left plate's reach here, the right one's don't.
    const Camera camera = camera_at({-2.8f, 2, 0}, {-2.8f, 0, 0}, 0.1f);
    const auto readers = [&](const Plates& plates, PictureOptions options = small_picture(32, 32, 8)) {
        Camera level = camera;
        level.up = {0, 0, -1};
        return light_map_readers(plates.scene, plates.sky, level, options);
    };
    using Flags = std::vector<std::uint8_t>;
    Plates plates;
    EXPECT_EQ(readers(plates), (Flags{1, 0}));
    EXPECT_EQ(readers(Plates(0.3f)), (Flags{0, 0}));
    EXPECT_EQ(readers(plates, small_picture(32, 32, kTooManySamplesForMaps)), (Flags{0, 0}));
    PictureOptions solved = small_picture(32, 32, 8);
    solved.pixel_shadows = false;
    EXPECT_EQ(readers(plates, solved), (Flags{0, 0}));
    plates.scene.looks[0].smooth_normals = false; // patches of leaves share lobes
    EXPECT_EQ(readers(plates), (Flags{0, 0}));
    plates.scene.looks[0].smooth_normals = true;
    plates.scene.looks[0].gloss.normal_reflectance = glm::vec3(0.f);
    EXPECT_EQ(readers(plates), (Flags{0, 0}));
}

double mean_value(const Image& image) {
    double sum = 0;
    for (const float value : image.pixels)
        sum += double(value);
    return sum / double(image.pixels.size());
}

TEST(LightMapGloss, IsSetRightByRaysThatAreGathered) {
    // These maps are twice as bright as the sky that the plates see.
    const Plates plates(0.8f, even_map(2), even_map(2));
    Camera camera = camera_at({0, 3, 0}, {0, 0, 0}, 0.2f);
    camera.up = {0, 0, -1};
    PictureOptions options = small_picture(24, 24, 8);
    options.ground = PictureGround::none;
    options.layers = true;
    const RayQueries queries(plates.patches);
    const auto reflected = [&](int gather_rays) {
        options.gather_rays = gather_rays;
        return mean_value(
            render_picture(plates.scene, queries, plates.sky, camera, options, quiet_gloss).layers->reflection);
    };
    const double truth = mean_value(
        render_path_traced(plates.scene, queries, plates.sky, camera, options, quiet_gloss).layers->reflection);
    EXPECT_NEAR(reflected(0) / truth, 2, 0.06);
    EXPECT_NEAR(reflected(8) / truth, 1, 0.05);
}

} // namespace
} // namespace kokage::test
