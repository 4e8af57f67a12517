#include "common/obj/obj_scene.h"
#include "common/services/error.h"
#include "tests/benchmark/render_benchmark.h"
#include "tests/benchmark/render_judge.h"
#include "tests/benchmark/render_scenes.h"
#include "tests/benchmark/render_skips.h"
#include "tests/benchmark/render_tables.h"
#include "tests/benchmark/render_truth_hash.h"
#include "tests/benchmark/render_worst.h"
#include "tests/support/temporary_folder.h"

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sstream>

namespace kokage {
namespace {

/// A truth of 1 everywhere in four pixels, two of leaves and two of ground.
PictureTruth even_truth() {
    PictureTruth truth;
    truth.radiance.assign(4, glm::vec3(1.f));
    truth.half_difference.assign(4, glm::vec3(0.01f));
    truth.pixels = {0, 1, 2, 3};
    truth.kind = {0, 0, 3, 3};
    truth.mean = 1;
    truth.noise = 0.01;
    return truth;
}

PictureRecord record_of(const std::string& method, double cpu, double error) {
    PictureRecord record;
    record.scene = "close";
    record.method = method;
    record.cpu_seconds = cpu;
    record.mean_error = error;
    record.reference_noise = 0.001;
    return record;
}

TEST(RenderJudge, TellsErrorsByWhatIsSeen) {
    Image picture(4, 1, 3);
    picture.pixels = {1.2f, 1.2f, 1.2f, 0.8f, 0.8f, 0.8f, 1, 1, 1, 1.4f, 1.4f, 1.4f};
    PictureRecord record;
    judge(picture, even_truth(), record);
    EXPECT_NEAR(*record.mean_error, 0.2, 1e-6);
    EXPECT_NEAR(*record.bias, 0.1, 1e-6);
    EXPECT_NEAR(*record.p95_error, 0.4, 1e-6);
    EXPECT_NEAR(record.mean_error_of.at("leaf"), 0.2, 1e-6);
    EXPECT_NEAR(record.mean_error_of.at("ground"), 0.2, 1e-6);
    EXPECT_NEAR(record.share_of.at("leaf"), 0.5, 1e-6);
    EXPECT_FALSE(record.mean_error_of.contains("bark"));
    EXPECT_TRUE(is_judged(record));
    record.reference_noise = 0.05;
    EXPECT_FALSE(is_judged(record));
    const nlohmann::json json = to_json(record);
    for (const char* field : {"scene", "method", "effort", "cpu_seconds", "mean_error", "p95_error", "reference_noise"})
        EXPECT_TRUE(json.contains(field)) << field;
}

TEST(RenderJudge, TellsWhatMoreSamplesTakeAway) {
    // Leaves: 0.2 too bright in both pictures. Ground: 0.1 too bright in one, too dark in the other.
    Image one(4, 1, 3), two(4, 1, 3);
    for (std::size_t k = 0; k < 12; ++k) {
        one.pixels[k] = k < 6 ? 1.2f : 1.1f;
        two.pixels[k] = k < 6 ? 1.2f : 0.9f;
    }
    PictureTruth truth = even_truth();
    PictureRecord record;
    split_errors(one, two, truth, record);
    EXPECT_NEAR(record.systematic_error_of.at("leaf"), std::sqrt(0.04 - 1e-4), 1e-6); // less the truth's own noise
    EXPECT_NEAR(record.sampling_error_of.at("leaf"), 0, 1e-6);
    EXPECT_EQ(record.systematic_error_of.at("ground"), 0); // its product is negative
    EXPECT_NEAR(record.sampling_error_of.at("ground"), std::sqrt(0.02), 1e-6);
}

TEST(RenderJudge, TellsWhichLightIsWrong) {
    Picture drawn, traced;
    for (Picture* picture : {&drawn, &traced}) {
        PictureLayers& layers = picture->layers.emplace();
        for (Image* image : {&layers.direct, &layers.indirect, &layers.reflection}) {
            *image = Image(4, 1, 3);
            std::fill(image->pixels.begin(), image->pixels.end(), 0.3f);
        }
    }
    std::fill_n(drawn.layers->indirect.pixels.begin(), 6, 0.2f); // of both leaves
    drawn.layers->reflection.pixels[9] = 0.9f;                   // a channel of one of two pixels of ground
    PictureRecord record;
    split_bias(drawn, traced, even_truth(), record);
    EXPECT_NEAR(record.bias_by_light.at("leaf").at("indirect"), -0.1, 1e-6);
    EXPECT_NEAR(record.bias_by_light.at("leaf").at("direct"), 0, 1e-6);
    EXPECT_NEAR(record.bias_by_light.at("ground").at("reflected"), 0.1, 1e-6);
    EXPECT_FALSE(record.bias_by_light.contains("bark"));
}

TEST(RenderWorst, TellsTheWorstKindAndWhatMakesUpMost) {
    PictureRecord record = record_of("fast", 2, 0.05);
    record.mean_error_of = {{"bark", 0.2}, {"leaf", 0.04}};
    record.share_of = {{"bark", 0.0625}, {"leaf", 0.9375}};
    record.bias_of = {{"bark", -0.1}, {"leaf", 0.01}};
    record.systematic_error_of = {{"bark", 0.3}, {"leaf", 0.03}};
    record.sampling_error_of = {{"bark", 0.1}, {"leaf", 0.09}};
    record.bias_by_light["bark"] = {{"direct", 0.01}, {"indirect", -0.11}};
    const std::string text = worst_text({record});
    EXPECT_NE(text.find("the largest error is that of bark; leaf makes up 75.0 % of"), std::string::npos) << text;
    EXPECT_NE(text.find("bark 20.0 % on 6.25 % of the pixels (bias −10.0 %; systematic 90.0 % of the squared error; of "
                        "the bias −11.0 % in indirect light)"),
              std::string::npos)
        << text;
    EXPECT_EQ(worst_text({record_of("fast", 2, 0.05)}), ""); // not split
}

TEST(RenderTables, TimesAreComparedAtEqualError) {
    const PictureRecord fast = record_of("fast", 2, 0.05);
    const std::vector<PictureRecord> records = {record_of("path-traced", 10, 0.1), record_of("path-traced", 40, 0.05),
                                                record_of("path-traced", 160, 0.025), fast};
    EXPECT_NEAR(*times_less_cpu(records, fast), 20, 1e-6);
    // Beyond what was traced, a fifth of the error takes 25 times the time.
    EXPECT_NEAR(*times_less_cpu(records, record_of("fast", 2, 0.005)), 160 * 25 / 2, 1e-6);
    EXPECT_FALSE(times_less_cpu(records, record_of("fast", 2, 0.004))); // the truth is too noisy for that
    EXPECT_NE(render_figures(records).find("20.0×"), std::string::npos);
}

TEST(RenderJudge, TheTruthOfASmallSceneIsNearItsFastPicture) {
    const TemporaryFolder folder;
    SceneDescription description = render_scenes(48, 36, {}, folder.path())[1];
    description.trees[0].source.leaves = 300;
    const AssembledScene scene = assemble_scene(description, silent_progress());
    PictureOptions judged = description.picture;
    judged.every_row = 4;
    judged.every_column = 2;
    const TruthOptions options = {{}, folder.path() / "cache", 256};
    const PictureTruth truth = find_truth(scene, judged, "small", options, silent_progress());
    EXPECT_EQ(truth.kind.size(), truth.pixels.size());
    EXPECT_EQ(truth.samples, 256u);
    EXPECT_FALSE(truth.is_stored);
    EXPECT_GT(truth.noise, 0);
    EXPECT_LT(truth.noise, 0.1);
    for (const std::uint32_t pixel : truth.pixels) {
        EXPECT_EQ(pixel / 48 % 4, 0u);
        EXPECT_TRUE(is_traced(judged, int(pixel % 48), int(pixel / 48)));
    }
    // The pot is there, too: it was made, as there is no data.
    EXPECT_NE(std::find(truth.kind.begin(), truth.kind.end(), 2), truth.kind.end());
    const PictureTruth again = find_truth(scene, judged, "small", options, silent_progress());
    EXPECT_TRUE(again.is_stored);
    EXPECT_EQ(again.radiance, truth.radiance);
    RenderOptions fast;
    fast.picture = description.picture;
    PictureRecord record;
    judge(render_scene(scene, fast, silent_progress()).picture.radiance, truth, record);
    EXPECT_LT(*record.mean_error, 0.12);
    EXPECT_LT(std::abs(*record.bias), 0.05);
}

TEST(RenderSkips, OnAndOffStandBesideOneAnother) {
    PictureRecord on = record_of("skip: relief", 1, 0), off = record_of("skip: relief", 2, 0);
    on.effort = "on";
    on.change_by_skip = 0.001;
    on.note = "relief: too thin";
    off.effort = "off";
    EXPECT_NE(skip_table({on, off}).find("| relief | close | 1.00 | 2.00 | 0.100 | relief: too thin |"),
              std::string::npos)
        << skip_table({on, off});
}

TEST(RenderBenchmark, RefusesExperimentsThatThereAreNot) {
    const TemporaryFolder folder;
    std::ostringstream out;
    EXPECT_THROW(run_render_benchmark({.output_folder = folder.path(), .experiments = {"skips", "films"}},
                                      silent_progress(), out),
                 InputError);
    EXPECT_EQ(out.str(), ""); // before any work
}

TEST(RenderTruth, AHashChangesWithWhatThePictureDependsOn) {
    const TemporaryFolder folder;
    SceneDescription description = render_scenes(48, 36, {}, folder.path())[1];
    description.trees[0].source.leaves = 50;
    AssembledScene scene = assemble_scene(description, silent_progress());
    const std::uint64_t hash = picture_hash(scene, description.picture);
    EXPECT_EQ(picture_hash(assemble_scene(description, silent_progress()), description.picture), hash);
    const auto changed = [&](auto& number, auto to) {
        const auto from = number;
        number = to;
        const bool is_other = picture_hash(scene, description.picture) != hash;
        number = from;
        return is_other;
    };
    // The last bit of a number may differ between machines, and does not count.
    EXPECT_FALSE(changed(scene.patches.positions[7].x, std::nextafter(scene.patches.positions[7].x, 9.f)));
    EXPECT_TRUE(changed(scene.patches.positions[7].x, scene.patches.positions[7].x + 0.1f));
    EXPECT_TRUE(changed(scene.origins.normals[7].y, 0.f));
    EXPECT_TRUE(changed(scene.patches.optics[0].reflectance.g, 0.9f));
    EXPECT_TRUE(changed(scene.looks.back().gloss.normal_reflectance.r, 0.5f));
    EXPECT_TRUE(changed(scene.looks.front().relief.depth_m, 0.3f));
    EXPECT_TRUE(changed(scene.environment.distant_lights[0].irradiance.r, 0.1f));
    EXPECT_TRUE(changed(scene.camera.position.z, 7.1f));
    EXPECT_TRUE(changed(description.picture.every_row, 3));
    EXPECT_FALSE(changed(description.picture.seed, 3u)); // only of the pictures that are judged
}

TEST(RenderScenes, ThePotIsClosed) {
    const TemporaryFolder folder;
    std::ofstream(folder / "pot.obj") << turned_pot_obj();
    const MeshScene scene = read_obj_scene(folder / "pot.obj");
    ASSERT_EQ(scene.meshes.size(), 1u);
    // The divergence theorem: the sum of area times normal of a closed surface is 0.
    glm::dvec3 sum(0.0);
    double volume = 0;
    const SceneMesh& mesh = scene.meshes[0];
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
        sum += glm::cross(b - a, c - a);
        volume += glm::dot(a, glm::cross(b, c)) / 6;
    }
    EXPECT_LT(glm::length(sum), 1e-4);
    EXPECT_GT(volume, 1); // fronts look outwards
}

} // namespace
} // namespace kokage
