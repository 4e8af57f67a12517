// `kokage render` as a user runs it, on small scenes.
#include "common/scene/image_file.h"
#include "common/scene/image_layers.h"
#include "common/services/parallel.h"
#include "tests/support/program_run.h"
#include "tests/unit/viewer/words.h"
#include "viewer/scene/scene_memory.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

namespace kokage {
namespace {
using Json = nlohmann::json;

const Words kSmallRender = {"render", "oak", "--leaves", "200", "--size", "64x48", "--samples", "4"};

void write(const std::filesystem::path& path, const std::string& text) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << text;
}

/// Two trees, and a box of 40 cm in a material of uneven roughness, seen close.
std::string small_scene(const TemporaryFolder& folder) {
    write(folder / "box.obj", R"(
v -1 0 -1
v 1 0 -1
v 1 0 1
v -1 0 1
v -1 2 -1
v 1 2 -1
v 1 2 1
v -1 2 1
f 1 2 3 4
f 8 7 6 5
f 5 6 2 1
f 6 7 3 2
f 7 8 4 3
f 8 5 1 4
)");
    write(folder / "garden.json", R"({
        "kokage_scene": 1,
        "environment": {"sky": {"sun": [140, 40]}},
        "lights": [{"point": [0.5, 1.5, 2.5], "intensity": 2}],
        "materials": {"glaze": {"base_color": [0.1, 0.2, 0.6], "roughness_from_foot_to_top": [0.2, 0.7],
                                "index_of_refraction": 1.5}},
        "trees": [{"species": "oak", "leaves": 150}, {"species": "birch", "leaves": 80, "at": [-1.5, -1]}],
        "objects": [{"file": "box.obj", "height": 0.4, "at": [0.6, 0.6], "turn": 20, "material": "glaze"}],
        "camera": {"position": [0, 1, 4], "target": [0, 0.6, 0]},
        "output": {"size": [64, 48], "samples": 4}
    })");
    return "garden.json";
}

std::map<std::string, ImageLayer> layers_of(const std::filesystem::path& file) {
    std::map<std::string, ImageLayer> layers;
    for (ImageLayer& layer : load_layers(file))
        layers.emplace(layer.name, std::move(layer));
    return layers;
}

TEST(Render, DrawsASceneWithLayersAndReport) {
    TemporaryFolder folder;
    const std::string scene = small_scene(folder);
    for (const char* method : {"fast", "path-traced"}) {
        const ProgramRun run = run_kokage(
            {"render", scene, "-o", "a.png", "-o", "a.exr", "--report", "r.json", "--method", method}, folder.path());
        ASSERT_EQ(run.status, 0) << run.errors;
        EXPECT_EQ(run.errors, "");
        EXPECT_EQ(folder.files(), Words({"a.exr", "a.png", "box.obj", "garden.json", "r.json"}));
        for (const char* name : {"a.exr", "a.png", "r.json"})
            EXPECT_NE(run.output.find((std::filesystem::canonical(folder.path()) / name).string()), std::string::npos)
                << run.output;
        EXPECT_NE(run.output.find("garden: 2 trees, 1 object, 230 leaves"), std::string::npos) << run.output;
        EXPECT_NE(run.output.find(method + std::string(": 64 x 48 pixels, 4 rays a pixel")), std::string::npos);

        const Image shown = load_image(folder / "a.png");
        EXPECT_EQ(shown.width, 64);
        EXPECT_EQ(shown.height, 48);

        const Json report = Json::parse(read_text(folder / "r.json"));
        EXPECT_EQ(report["method"]["name"], method);
        EXPECT_EQ(report["inputs"]["scene"], "garden");
        EXPECT_EQ(report["inputs"]["trees"].size(), 2u);
        EXPECT_EQ(report["inputs"]["objects"][0]["material"], "glaze");
        EXPECT_EQ(report["counts"]["leaves"], 230);
        EXPECT_EQ(report["picture"]["samples"], 4);
        EXPECT_GT(report["picture"]["subject_share"], 0.05);
        EXPECT_LT(report["picture"]["subject_share"], 1);
        EXPECT_GT(report["picture"]["subject_mean_luminance"], 0);
        EXPECT_GT(report["peak_memory_bytes"], 1e6);
        double stages = 0;
        for (const Json& stage : report["stages"])
            stages += stage["cpu_seconds"].get<double>();
        EXPECT_GT(stages, 0);
        EXPECT_LE(stages, report["cpu_seconds"].get<double>() + 0.01) << "no stage is told twice";
        EXPECT_GE(stages, 0.95 * report["cpu_seconds"].get<double>() - 0.01) << "all is told";
        for (const char* key : {"skipped", "warnings"})
            EXPECT_TRUE(report[key].is_array()) << key;
        EXPECT_EQ(report["outputs"]["picture"], Json({"a.png", "a.exr"}));
    }
}

TEST(Render, LayersAddUpToTheRadiance) {
    TemporaryFolder folder;
    const std::string scene = small_scene(folder);
    for (const char* method : {"fast", "path-traced"}) {
        ASSERT_EQ(run_kokage({"render", scene, "-o", "a.exr", "--method", method}, folder.path()).status, 0);
        const auto layers = layers_of(folder / "a.exr");
        for (const char* name : {"", "albedo", "direct", "indirect", "reflection"}) {
            ASSERT_TRUE(layers.contains(name)) << name;
            EXPECT_EQ(layers.at(name).channel_names, Words({"R", "G", "B"})) << name;
        }
        EXPECT_EQ(layers.at("normal").channel_names, Words({"X", "Y", "Z"}));
        EXPECT_EQ(layers.at("depth").channel_names, Words({"Z"}));
        EXPECT_EQ(layers.at("leaf").channel_names, Words({"id"}));
        EXPECT_EQ(layers.size(), 8u);
        int inside = 0, sky = 0, leaves = 0;
        double reflection = 0;
        for (int y = 0; y < 48; ++y)
            for (int x = 0; x < 64; ++x) {
                const float depth = *layers.at("depth").image.at(x, y);
                if (!std::isfinite(depth)) {
                    ++sky;
                    continue;
                }
                EXPECT_GT(depth, 0);
                leaves += *layers.at("leaf").image.at(x, y) > 0;
                reflection += double(layers.at("reflection").image.at(x, y)[2]);
                const float* n = layers.at("normal").image.at(x, y);
                EXPECT_NEAR(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1, 1e-3);
                // The lowest rows show nothing but surfaces and ground: no share of sky in their pixels.
                for (int c = 0; c < 3 && y > 40; ++c, ++inside) {
                    const float whole = layers.at("").image.at(x, y)[c];
                    const float sum = layers.at("direct").image.at(x, y)[c] + layers.at("indirect").image.at(x, y)[c] +
                                      layers.at("reflection").image.at(x, y)[c];
                    EXPECT_NEAR(sum, whole, 1e-4f * (1 + std::abs(whole))) << method << " " << x << " " << y;
                }
            }
        EXPECT_GT(inside, 1000);
        EXPECT_GT(sky, 100);
        EXPECT_GT(leaves, 20);
        EXPECT_GT(reflection, 0) << "the glaze mirrors";
    }
}

TEST(Render, GivesTheSameBitsForAnyNumberOfThreads) {
    TemporaryFolder folder;
    const std::string scene = small_scene(folder);
    for (const char* method : {"fast", "path-traced"}) {
        for (const char* threads : {"1", "2"})
            ASSERT_EQ(run_kokage({"render", scene, "-o", std::string(threads) + ".exr", "-o",
                                  std::string(threads) + ".png", "--method", method, "--threads", threads},
                                 folder.path())
                          .status,
                      0);
        EXPECT_TRUE(read_text(folder / "1.exr") == read_text(folder / "2.exr")) << method;
        EXPECT_TRUE(read_text(folder / "1.png") == read_text(folder / "2.png")) << method;
    }
}

TEST(Render, DrawsJustATreeAndNamesItAfterIt) {
    TemporaryFolder folder;
    const ProgramRun run = run_kokage(joined(kSmallRender, {"--sun", "250,12"}), folder.path());
    ASSERT_EQ(run.status, 0) << run.errors;
    EXPECT_EQ(folder.files(), Words({"oak.png"}));
    const Image picture = load_image(folder / "oak.png");
    EXPECT_GT(*std::max_element(picture.pixels.begin(), picture.pixels.end()), 0.1f);
}

TEST(Render, ComparesRadianceOfLayeredPictures) {
    TemporaryFolder folder;
    ASSERT_EQ(run_kokage(joined(kSmallRender, {"-o", "a.exr"}), folder.path()).status, 0);
    ASSERT_EQ(run_kokage(joined(kSmallRender, {"-o", "b.exr", "--method", "path-traced"}), folder.path()).status, 0);
    const ProgramRun same = run_kokage({"compare", "a.exr", "a.exr"}, folder.path());
    ASSERT_EQ(same.status, 0) << same.errors;
    EXPECT_NE(same.output.find("mean relative error  0 %"), std::string::npos) << same.output;
    EXPECT_NE(same.output.find("radiance; layer by layer:"), std::string::npos) << same.output;
    const ProgramRun other = run_kokage({"compare", "a.exr", "b.exr", "--report", "c.json"}, folder.path());
    ASSERT_EQ(other.status, 0) << other.errors;
    const Json report = Json::parse(read_text(folder / "c.json"));
    EXPECT_GT(report["error"]["mean_relative"], 0);
    for (const char* layer : {"albedo", "direct", "indirect", "reflection"})
        EXPECT_TRUE(report["layers"].contains(layer)) << layer;
    EXPECT_LT(report["layers"]["albedo"]["mean"], 0.05);
    EXPECT_LT(report["layers"]["depth"]["p95"], 5);
    EXPECT_LT(report["layers"]["depth"]["pixels_finite_in_one"], 64 * 48 / 4);
    EXPECT_GT(report["layers"]["leaf"]["differing_share"], 0);
    EXPECT_LT(report["layers"]["leaf"]["differing_share"], 0.5);
}

TEST(Render, PrintsSchemaAndAnExampleThatReads) {
    TemporaryFolder folder;
    const ProgramRun schema = run_kokage({"render", "--schema"}, folder.path());
    EXPECT_EQ(schema.status, 0);
    EXPECT_EQ(Json::parse(schema.output)["title"], "A scene of kokage");
    const ProgramRun example = run_kokage({"render", "--example"}, folder.path());
    EXPECT_EQ(example.status, 0);
    EXPECT_EQ(Json::parse(example.output, nullptr, true, true)["kokage_scene"], 1);
    EXPECT_EQ(run_kokage({"render", "--example", "--schema"}, folder.path()).status, 2);
}

TEST(Render, GathersAsManyRaysAsAskedFor) {
    const TemporaryFolder folder;
    small_scene(folder);
    const auto rays = [&](const Words& words) {
        const ProgramRun run =
            run_kokage(joined({"render", "garden.json", "--samples", "8", "--report", "r.json", "-o", "p.png"}, words),
                       folder.path());
        EXPECT_EQ(run.status, 0) << run.errors;
        return nlohmann::json::parse(read_text(folder / "r.json"))["counts"].value("gathering rays", 0);
    };
    EXPECT_EQ(rays({"--gather-rays", "0"}), 0);
    const int one = rays({"--gather-rays", "1"});
    EXPECT_GT(one, 0);
    EXPECT_GT(rays({}), one); // a quarter of the samples: 2
}

TEST(Render, LeavesFormerPicturesWholeWhenStopped) {
    TemporaryFolder folder;
    write(folder / "oak.png", "former");
    ProgramRunOptions stopped;
    stopped.interrupt_after_seconds = 0.3;
    const ProgramRun run =
        run_kokage({"render", "oak", "--size", "2000x2000", "--samples", "4096", "--method", "path-traced"},
                   folder.path(), stopped);
    EXPECT_EQ(run.status, 130);
    EXPECT_EQ(run.errors, "kokage: stopped; nothing was written\n");
    EXPECT_EQ(folder.files(), Words({"oak.png"}));
    EXPECT_EQ(read_text(folder / "oak.png"), "former");
}

TEST(Render, RefusesBadInputInOneLineAndWritesNothing) {
    TemporaryFolder folder;
    small_scene(folder);
    write(folder / "bad.json", R"({"kokage_scene": 1, "trees": [{"species": "oak", "at": ["x", 0]}]})");
    write(folder / "broken.json", R"({"kokage_scene": 1, )");
    write(folder / "low.json", R"({"kokage_scene": 1, "trees": [{"species": "oak", "leaves": 20}],
        "camera": {"position": [0, -0.5, 5], "target": [0, 1, 0]}})");
    write(folder / "light.hdr", "no picture");
    write(folder / "a.png", "former");
    const std::vector<std::pair<Words, const char*>> cases = {
        {{"bad.json"}, "bad.json: /trees/0/at/0: found \"x\" where a number from -10000 to 10000 is needed"},
        {{"broken.json"}, "broken.json: line 1"},
        {{"none.json"}, "'none.json' is not there; give a scene or a species file"},
        {{"garden.json", "--leaves", "10"}, "--leaves: it is for a single tree; the scene 'garden.json' says"},
        {{"garden.json", "--sun", "10,10"}, "--sun: it is for a single tree"},
        {{"garden.json", "--no-ground"}, "--no-ground: it is for a single tree"},
        {{"garden.json", "-o", "garden.json"}, "the picture can't be 'garden.json'"},
        {{"garden.json", "-o", "a.jpg"}, "the picture can't be 'a.jpg': the ending .jpg is not known"},
        {{"garden.json", "-o", "a.png", "-o", "./a.png"}, "is named twice"},
        {{"garden.json", "--report", "garden.json"}, "is named twice"},
        {{"garden.json", "-o", "a.exr", "--exposure", "1"}, "--exposure: .exr pictures hold the light as it is"},
        {{"garden.json", "--exposure", "1e9"}, "--exposure: it must be from -100 to 100 stops"},
        {{"garden.json", "--size", "0x10"}, "--size"},
        {{"garden.json", "--samples", "0"}, "--samples"},
        {{"garden.json", "--method", "bundles"}, "--method: 'bundles' is not known; give fast or path-traced"},
        {{"garden.json", "--method", "path-traced", "--error", "0.1"}, "--error: path-traced has none but its noise"},
        {{"garden.json", "--error", "0"}, "--error: it must be above 0"},
        {{"garden.json", "--gather-rays", "-1"}, "--gather-rays"},
        {{"garden.json", "--method", "path-traced", "--gather-rays", "2"}, "--gather-rays: path-traced follows every"},
        {{"low.json"}, "low.json: /camera/position: its height, -0.5 m, is below the ground's, 0 m"},
        {{"oak", "--leaves", "abc"}, "--leaves: 'abc' is not a number"},
        {{"oak", "--set", "limbs=x"}, "--set: limbs = 'x' can't be read; it takes"},
        {{"oak", "--set", "limbs=9", "--set", "limbs=9"}, "--set: 'limbs' is given twice"},
        {{"oak", "--environment", "none.hdr", "--data", "."},
         "--environment: there is no file 'none.hdr'; give an image (.hdr, .exr, .png), or sky, constant or gradient; "
         "it was looked for here, in '.' and in that folder's env"},
        {{"light.hdr"}, "'light.hdr' is an image; give a tree"},
        {{"oak", "--leaves", "200", "--scale", "2"}, "--foliage, --leaf-size, --scale and --up are for files"},
        {{"garden.json", "--data", "nowhere"}, "there is no folder 'nowhere'"},
        {{"garden.json", "--size", "32768x32768", "-o", "a.exr"}, "make it smaller, or ask for fewer samples"},
        {{"garden.json", "--size", "32768x32768", "-o", "a.exr", "--samples", "1"}, "can be had: make it smaller\n"},
    };
    const Words before = folder.files();
    for (const auto& [words, complaint] : cases) {
        const ProgramRun run = run_kokage(joined({"render"}, words), folder.path());
        EXPECT_EQ(run.status, 2) << words.front() << " " << words.back() << run.errors;
        EXPECT_TRUE(is_one_complaint(run.errors));
        EXPECT_NE(run.errors.find(complaint), std::string::npos) << complaint << "\n" << run.errors;
    }
    EXPECT_EQ(folder.files(), before);
    EXPECT_EQ(read_text(folder / "a.png"), "former");
}

TEST(Render, FilesThatOutgrowTheirLimitAreTakenAway) {
    TemporaryFolder folder;
    ProgramRunOptions limited;
    limited.file_size = 2000;
    for (const char* picture : {"a.exr", "a.png"}) {
        write(folder / picture, "former");
        const ProgramRun run = run_kokage(joined(kSmallRender, {"-o", picture, "--quiet"}), folder.path(), limited);
        EXPECT_EQ(run.status, 2) << picture;
        EXPECT_TRUE(is_one_complaint(run.errors));
        EXPECT_NE(run.errors.find(picture), std::string::npos) << run.errors;
        EXPECT_EQ(folder.files(), Words({picture}));
        EXPECT_EQ(read_text(folder / picture), "former");
        std::filesystem::remove(folder / picture);
    }
}

TEST(Render, EstimatesTheMemoryOfPictures) {
    TemporaryFolder folder;
    small_scene(folder); // writes box.obj; nothing else here that takes memory
    write(folder / "box.json", R"({"kokage_scene": 1, "environment": {"constant": 1},
        "materials": {"matt": {"index_of_refraction": 1}}, "objects": [{"file": "box.obj", "material": "matt"}]})");
    const Words few = {"render", "box.json", "--samples", "1", "--threads", "2", "--quiet"};
    const std::vector<char> of_parent(300'000'000, 1); // has no part in what the program reports
    const auto megabytes = [&](const Words& more) {
        const ProgramRun run = run_kokage(joined(joined(few, more), {"--report", "r.json"}), folder.path());
        EXPECT_EQ(run.status, 0) << run.errors;
        return Json::parse(read_text(folder / "r.json"))["peak_memory_bytes"].get<double>() / 1e6;
    };
    const double without = megabytes({"--size", "16x12"});
    set_thread_count(2);
    for (const bool layers : {false, true}) {
        PictureOptions options;
        options.width = 2000;
        options.height = 1000;
        options.samples = 1;
        options.layers = layers;
        const double estimated = estimated_picture_bytes(options) / 1e6,
                     taken = megabytes({"--size", "2000x1000", "-o", layers ? "a.exr" : "a.png"}) - without;
        EXPECT_GT(estimated, 0.9 * taken);
        EXPECT_LT(estimated, 2 * taken);
    }
    set_thread_count(0);
}

TEST(Render, WarnsInTheWordsOfSceneFiles) {
    TemporaryFolder folder;
    write(folder / "night.json", R"({
        "kokage_scene": 1, "environment": {"sky": {"sun": [90, -10]}},
        "lights": [{"sun": [10, 20], "irradiance": 1}, {"directional": [10, -20.1], "irradiance": [0.1, 1, 2]},
                   {"directional": [10, -20.1], "irradiance": [0.1, 1, 2]},
                   {"point": [1, -2, 1], "intensity": 5}],
        "trees": [{"species": "oak", "leaves": 20}], "output": {"size": [16, 12], "samples": 1}})");
    const ProgramRun run = run_kokage({"render", "night.json", "--quiet"}, folder.path());
    ASSERT_EQ(run.status, 0) << run.errors;
    const std::string beginning = "kokage: warning: night.json: ";
    for (const std::string warning :
         {"/environment/sky/sun: the sun is below the horizon", "/lights/1: the light is below the horizon",
          "/lights/2: the light is below the horizon", "/lights/3: the light is under the ground"})
        EXPECT_NE(run.errors.find(beginning + warning), std::string::npos) << run.errors;
    EXPECT_EQ(run.errors.find("--"), std::string::npos) << run.errors;
    EXPECT_NE(run.errors.find("(\"ground\": false lets light through from below)"), std::string::npos) << run.errors;

    write(folder / "studio.hdr", "no picture");
    write(folder / "studio.json", R"({"kokage_scene": 1, "environment": "studio.hdr", "trees": [{"species": "oak"}]})");
    const ProgramRun broken = run_kokage({"render", "studio.json"}, folder.path());
    EXPECT_EQ(broken.status, 2);
    EXPECT_EQ(broken.errors.find("kokage: studio.json: /environment: "), 0u) << broken.errors;
}

TEST(Render, SaysThatNoFoliageWasFound) {
    TemporaryFolder folder;
    write(folder / "post.obj", "v 0 0 0\nv 0.1 0 0\nv 0 0 0.1\nv 0 2 0\nusemtl paint\n"
                               "f 1 2 4\nf 2 3 4\nf 3 1 4\nf 1 3 2\n");
    write(folder / "posts.json",
          R"({"kokage_scene": 1, "trees": [{"file": "post.obj"}, {"file": "post.obj", "at": [1, 0]}],
        "output": {"size": [16, 12], "samples": 1}})");
    const ProgramRun run = run_kokage({"render", "posts.json", "--quiet", "--report", "r.json"}, folder.path());
    ASSERT_EQ(run.status, 0) << run.errors;
    const std::string warning =
        "kokage: warning: posts.json: /trees/0: no foliage was found: all is taken for bark; give "
        "'foliage': [NAME], a material, mesh or node of the file; its materials are 'paint'\n";
    EXPECT_EQ(run.errors.rfind(warning, 0), 0u) << run.errors;
    EXPECT_EQ(run.errors.find("no foliage", warning.size()), std::string::npos) << "once for one file: " << run.errors;
    EXPECT_NE(Json::parse(read_text(folder / "r.json"))["warnings"].dump().find("no foliage"), std::string::npos);
    const ProgramRun alone =
        run_kokage({"render", "post.obj", "--quiet", "--size", "16x12", "--samples", "1"}, folder.path());
    EXPECT_NE(alone.errors.find("post.obj: no foliage was found: all is taken for bark; give --foliage NAME"),
              std::string::npos)
        << alone.errors;
    const ProgramRun bare = run_kokage(
        {"render", "oak", "--leaves", "100", "--set", "season=winter", "--quiet", "--size", "16x12", "--samples", "1"},
        folder.path());
    EXPECT_EQ(bare.errors, "");
}

TEST(Render, TakesASpeciesFileAsATree) {
    TemporaryFolder folder;
    write(folder / "my.json", R"({"name": "my oak", "parameters": {"leaves": 120}})");
    const ProgramRun run = run_kokage({"render", "my.json", "--size", "32x24", "--samples", "1"}, folder.path());
    ASSERT_EQ(run.status, 0) << run.errors;
    EXPECT_EQ(folder.files(), Words({"my.json", "my.png"}));
}

} // namespace
} // namespace kokage
