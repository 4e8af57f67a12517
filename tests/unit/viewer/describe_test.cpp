// `kokage describe`, and how a tree is named on the command line.
#include "common/scene/image_file.h"
#include "tests/support/program_run.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

namespace kokage {
namespace {

TEST(Describe, TellsWhatASpeciesGrowsInto) {
    TemporaryFolder folder;
    const ProgramRun run = run_kokage({"describe", "oak", "--leaves", "500", "--set", "seed=3"}, folder.path());
    ASSERT_EQ(run.status, 0) << run.errors;
    EXPECT_EQ(run.output.rfind("tree         oak (grown: oak, seed 3)\n", 0), 0u) << run.output;
    EXPECT_NE(run.output.find("leaves       500, "), std::string::npos);
    EXPECT_NE(run.output.find("branching    known"), std::string::npos);
    EXPECT_NE(run.output.find("  order 0    1 branch,"), std::string::npos);
    EXPECT_EQ(run.errors, "");
    EXPECT_TRUE(folder.files().empty());
}

TEST(Describe, JsonSaysTheSame) {
    TemporaryFolder folder;
    const ProgramRun run = run_kokage({"describe", "oak", "--leaves", "500", "--json"}, folder.path());
    ASSERT_EQ(run.status, 0) << run.errors;
    const nlohmann::json json = nlohmann::json::parse(run.output);
    EXPECT_EQ(json["leaves"]["count"], 500);
    EXPECT_EQ(json["branching"]["known"], true);
    EXPECT_EQ(json["branching"]["orders"][0]["branches"], 1);
    EXPECT_EQ(json["surfaces"].size(), 3u); // bark of limbs, leaves, bark of twigs
}

TEST(Describe, DrawsWhatItFound) {
    TemporaryFolder folder;
    const ProgramRun run =
        run_kokage({"describe", "oak", "--leaves", "300", "--image", "found.png", "--maps", "7"}, folder.path());
    ASSERT_EQ(run.status, 0) << run.errors;
    EXPECT_NE(run.output.find("0 brown, 1 red, 2 orange"), std::string::npos) << run.output;
    EXPECT_NE(run.output.find("7 light maps"), std::string::npos) << run.output;
    const Image image = load_image(folder / "found.png");
    ASSERT_EQ(image.width, 2 * image.height);
    // Both panels show colours on white: leaves by branch on the left, wood by generation on the right.
    for (const int from : {0, image.height}) {
        std::size_t white = 0, colored = 0;
        for (int y = 0; y < image.height; ++y)
            for (int x = from; x < from + image.height; ++x) {
                const float* pixel = image.at(x, y);
                const float high = std::max({pixel[0], pixel[1], pixel[2]}),
                            low = std::min({pixel[0], pixel[1], pixel[2]});
                white += low > 0.99f;
                colored += high - low > 0.2f;
            }
        EXPECT_GT(white, std::size_t(image.height * image.height) / 4);
        EXPECT_GT(colored, std::size_t(image.height * image.height) / 200);
    }
    EXPECT_EQ(folder.files().size(), 1u);
}

TEST(Describe, DamagedTexturesAreSaidInOneLine) {
    TemporaryFolder folder;
    Image image(64, 64, 3);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        image.pixels[i] = float((i * 37) % 101) / 101.f;
    save_image(folder / "leaf.png", image);
    std::fstream png(folder / "leaf.png", std::ios::binary | std::ios::in | std::ios::out);
    png.seekp(std::streamoff(std::filesystem::file_size(folder / "leaf.png") / 2)).write("\x01\x02\x03\x04", 4);
    png.close();
    std::ofstream(folder / "tree.mtl") << "newmtl leaf\nmap_Kd leaf.png\n";
    std::ofstream(folder / "tree.obj") << "mtllib tree.mtl\nusemtl leaf\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const ProgramRun run = run_kokage({"describe", "tree.obj"}, folder.path());
    EXPECT_EQ(run.status, 2);
    EXPECT_EQ(std::count(run.errors.begin(), run.errors.end(), '\n'), 1) << run.errors;
    EXPECT_NE(run.errors.find("its pixels are damaged ("), std::string::npos) << run.errors;
}

TEST(Describe, AFileWhoseZIsUpIsSetUpright) {
    TemporaryFolder folder;
    std::ofstream(folder / "tree.obj") << "v 0 0 0\nv 1 0 0\nv 0 0 4\nf 1 2 3\n";
    const auto height = [&](const std::vector<std::string>& more) {
        std::vector<std::string> words{"describe", "tree.obj"};
        words.insert(words.end(), more.begin(), more.end());
        return run_kokage(words, folder.path()).output;
    };
    EXPECT_EQ(height({}).find("4 m high"), std::string::npos);
    EXPECT_NE(height({"--up", "Z"}).find("4 m high"), std::string::npos) << height({"--up", "Z"});
}

TEST(Describe, LooksInTheDataFolderAndNamesNoSpeciesForAFile) {
    TemporaryFolder folder;
    std::filesystem::create_directories(folder / "data/trees");
    ASSERT_EQ(run_kokage({"grow", "--leaves", "50", "-o", "data/trees/tiny.glb", "--quiet"}, folder.path()).status, 0);
    const ProgramRun run = run_kokage({"describe", "tiny.glb", "--data", "data"}, folder.path());
    EXPECT_EQ(run.status, 0) << run.errors;
    EXPECT_NE(run.output.find("leaves       50"), std::string::npos) << run.output;
    for (const char* name : {"other.glb", "other.gltf", "other.OBJ"}) {
        const ProgramRun missing = run_kokage({"describe", name, "--data", "data"}, folder.path());
        EXPECT_EQ(missing.status, 2);
        EXPECT_TRUE(is_one_complaint(missing.errors));
        EXPECT_NE(missing.errors.find("--data"), std::string::npos) << missing.errors;
        EXPECT_EQ(missing.errors.find("species"), std::string::npos) << missing.errors;
    }
}

TEST(Describe, WrongTreesAreRefusedInOneLine) {
    TemporaryFolder folder;
    std::ofstream(folder / "not a tree.glb") << "nothing of the kind";
    std::filesystem::create_directory(folder / "folder");
    const std::vector<std::pair<std::vector<std::string>, std::string>> wrongs = {
        {{"describe"}, "TREE"},
        {{"describe", "baobab"}, "species: aspen, beech"},
        {{"describe", "missing tree.glb"}, "missing tree.glb"},
        {{"describe", "folder"}, "folder"},
        {{"describe", "not a tree.glb"}, "not a tree.glb"},
        {{"describe", "oak", "--leaves", "0"}, "leaves"},
        {{"describe", "oak", "--leaves", "many"}, "many"},
        {{"describe", "oak", "--leaves", "1e12"}, "it takes a whole number, 1 to 2000000"},
        {{"describe", "oak", "--set", "height=12"}, "height_to_width"},
        {{"describe", "oak", "--up", "z"}, "--up"},
        {{"describe", "not a tree.glb", "--up", "x"}, "--up"},
        {{"describe", "oak", "--set", "leaves"}, "NAME=VALUE"},
        {{"describe", "oak", "--set", "leavs=4"}, "leaves"},
        {{"describe", "oak", "--scale", "2"}, "--scale"},
        {{"describe", "not a tree.glb", "--leaves", "7"}, "--leaves"},
        {{"describe", "not a tree.glb", "--scale", "0"}, "--scale"},
        {{"describe", "not a tree.glb", "--leaf-size", "-1"}, "--leaf-size"},
        {{"describe", "oak", "--threads", "-1"}, "--threads"},
        {{"describe", "oak", "--image", "found.jpg"}, ".png"},
        {{"describe", "oak", "--image", "no folder/found.png"}, "no folder"},
        {{"describe", "oak", "--maps", "0"}, "--maps"},
    };
    for (const auto& [words, hint] : wrongs) {
        const ProgramRun run = run_kokage(words, folder.path());
        EXPECT_EQ(run.status, 2) << hint << run.errors;
        EXPECT_TRUE(is_one_complaint(run.errors)) << hint;
        EXPECT_NE(run.errors.find(hint), std::string::npos) << run.errors;
        EXPECT_EQ(run.output, "");
    }
}

} // namespace
} // namespace kokage
