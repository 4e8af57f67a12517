#include "common/services/error.h"
#include "tests/benchmark/environments.h"
#include "tests/benchmark/find_reference.h"
#include "tests/benchmark/scene_hash.h"

#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>

namespace kokage {
namespace {

class FindReference : public testing::Test {
  protected:
    void SetUp() override {
        const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
        folder_ = std::filesystem::path(testing::TempDir()) / ("kokage-" + name + std::to_string(::getpid()));
        std::filesystem::create_directories(folder_ / "stored");
        options_.stored_folder = folder_ / "stored";
        options_.cache_folder = folder_ / "cache";
        options_.paths_per_side = 8;
        options_.paths_per_chunk = 2;
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    static BenchScene scene(BenchLight light = BenchLight::point_light) {
        return BenchScenes("").make({light, 60, BenchMaterial::realistic});
    }
    std::filesystem::path folder_;
    ReferenceOptions options_;
};

TEST_F(FindReference, hash_knows_everything_that_light_depends_on) {
    const BenchScene original = scene();
    const std::uint64_t hash = scene_hash(original);
    EXPECT_EQ(hash, scene_hash(scene())) << "the same scene made again";
    const auto changed = [&](auto change) {
        BenchScene other = original;
        auto environment = std::make_shared<Environment>(*original.environment);
        change(other.patches, *environment);
        other.environment = environment;
        return scene_hash(other) != hash;
    };
    EXPECT_TRUE(changed([](PatchScene& s, Environment&) { s.positions[s.triangles[5].y].z += 1e-6f; }));
    EXPECT_TRUE(changed([](PatchScene& s, Environment&) { s.optics.back().reflectance.g += 1e-4f; }));
    EXPECT_TRUE(changed([](PatchScene& s, Environment&) { s.ground->albedo.r = 0.21f; }));
    EXPECT_TRUE(changed([](PatchScene& s, Environment&) { s.ground->height_m = 0.1f; }));
    EXPECT_TRUE(changed([](PatchScene& s, Environment&) { s.ground.reset(); }));
    EXPECT_TRUE(changed([](PatchScene&, Environment& e) { e.remainder.pixels[0] *= 1.001f; }));
    EXPECT_TRUE(changed([](PatchScene&, Environment& e) { e.point_lights[0].position.x += 0.01f; }));
    EXPECT_TRUE(changed([](PatchScene&, Environment& e) { e.point_lights[0].intensity.g *= 1.001f; }));
    EXPECT_TRUE(changed([](PatchScene&, Environment& e) { e.distant_lights.push_back({}); }));
    EXPECT_FALSE(changed([](PatchScene&, Environment& e) { e.remainder.pixels[0] *= 1.f + 1e-7f; }))
        << "the last bit of a float, which machines differ in";
    EXPECT_FALSE(changed([](PatchScene&, Environment& e) { e.description = "another name"; }));
}

TEST_F(FindReference, stored_one_of_this_scene_is_used) {
    const BenchScene this_scene = scene();
    Reference marked{scene_hash(this_scene), 8, 0.01, std::vector<glm::vec3>(120, glm::vec3(0.25f))};
    save_reference(options_.stored_folder / reference_file_name(this_scene.name), marked);
    EXPECT_EQ(find_or_make_reference(this_scene, options_, silent_progress()).sides[7], glm::vec3(0.25f));
    EXPECT_FALSE(std::filesystem::exists(options_.cache_folder));
}

TEST_F(FindReference, one_of_another_scene_is_made_again_and_not_used) {
    const BenchScene this_scene = scene();
    const Reference wrong{scene_hash(this_scene) + 1, 1 << 20, 1e-6, std::vector<glm::vec3>(120, glm::vec3(0.25f))};
    const auto stored = options_.stored_folder / reference_file_name(this_scene.name);
    save_reference(stored, wrong);
    EXPECT_FALSE(find_reference(this_scene, options_));
    const Reference made = find_or_make_reference(this_scene, options_, silent_progress());
    EXPECT_EQ(made.scene_hash, scene_hash(this_scene));
    EXPECT_EQ(made.paths_per_side, 8u);
    EXPECT_GT(made.noise, 0.0);
    EXPECT_NE(made.sides[7], glm::vec3(0.25f));
    EXPECT_EQ(load_reference(stored)->scene_hash, wrong.scene_hash) << "the stored folder is never written";
    // The next run finds it in the cache.
    const auto found = find_reference(this_scene, options_);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->sides, made.sides);
}

TEST_F(FindReference, work_that_was_stopped_goes_on_to_the_same_result) {
    const BenchScene this_scene = scene();
    const Reference whole = find_or_make_reference(this_scene, options_, silent_progress());
    ReferenceOptions halves = options_;
    halves.cache_folder = folder_ / "other";
    halves.paths_per_side = 4;
    find_or_make_reference(this_scene, halves, silent_progress());
    halves.paths_per_side = 8;
    const Reference continued = find_or_make_reference(this_scene, halves, silent_progress());
    EXPECT_EQ(continued.sides, whole.sides);
    EXPECT_EQ(continued.noise, whole.noise);
}

TEST_F(FindReference, lamp_lit_scenes_say_what_is_missing) {
    BenchScenes scenes(folder_);
    const BenchSceneName name{BenchLight::lamp_lit, 60, BenchMaterial::realistic};
    EXPECT_NE(scenes.why_not(name).find("interior_hotel.exr"), std::string::npos);
    EXPECT_THROW(scenes.make(name), InputError);
    EXPECT_NE(BenchScenes("").why_not(name).find("KOKAGE_DATA"), std::string::npos);
}

TEST_F(FindReference, furnace_lets_nothing_be_absorbed) {
    const BenchScene furnace = BenchScenes("").make({BenchLight::furnace, 60, BenchMaterial::white});
    for (const Optics& optics : furnace.patches.optics)
        EXPECT_EQ(optics.reflectance + optics.transmittance, glm::vec3(1.f));
    EXPECT_FALSE(furnace.patches.ground);
}

TEST_F(FindReference, another_sky_keeps_the_lights) {
    const BenchScene this_scene = scene(BenchLight::sky_sun);
    const Environment other = with_another_sky(*this_scene.environment);
    ASSERT_EQ(other.distant_lights.size(), this_scene.environment->distant_lights.size());
    ASSERT_EQ(other.distant_lights.size(), 1u);
    EXPECT_EQ(other.distant_lights[0].direction, this_scene.environment->distant_lights[0].direction);
    EXPECT_EQ(other.distant_lights[0].irradiance, this_scene.environment->distant_lights[0].irradiance);
    EXPECT_NE(environment_hash(other), environment_hash(*this_scene.environment));
}

} // namespace
} // namespace kokage
