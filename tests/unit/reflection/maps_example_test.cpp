// The example that reflection/README.md shows: it compiles, gives what it says, and stands there as it is here.
#include "tests/unit/reflection/example/glossy_light.h"

#include "common/environment/lat_long.h"
#include "common/scene/image_file.h"
#include "reflection/maps/brute_force_baker.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

Environment dawn() {
    Environment environment;
    environment.remainder = Image(64, 32, 3);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 64; ++x) {
            const glm::dvec3 d = pixel_direction(x, y, 64, 32);
            for (int c = 0; c < 3; ++c)
                environment.remainder.at(x, y)[c] = float(1.2 + d.y + 0.2 * (c - 1) * d.x);
        }
    return environment;
}

TEST(MapsExample, GivesTheLightThatASurfaceMirrors) {
    const TemporaryFolder folder;
    const Environment environment = dawn();
    save_image(folder / "dawn.exr", environment.remainder);
    const GlossyLight light(folder / "dawn.exr");
    const glm::vec3 normal = glm::normalize(glm::vec3(1, 2, -1));
    for (const float roughness : {0.1f, 0.35f, 0.8f}) {
        const glm::dvec3 truth =
            filtered_by_brute_force(environment, {LobeKind::ggx, double(roughness)}, glm::dvec3(normal));
        EXPECT_LT(glm::distance(glm::dvec3(light.reflected(normal, normal, roughness)), truth), 0.01) << roughness;
    }
    // Flat on the ground and seen along it: half of a rough lobe lies below, where there is no light to take.
    const glm::vec3 up(0, 1, 0), along = glm::normalize(glm::vec3(1, 0.02f, 0));
    EXPECT_LT(light.reflected(up, along, 0.9f).y, 0.9f);
    EXPECT_GT(light.reflected(up, along, 0.9f).y, 0.5f);
    const glm::vec3 slanting = glm::normalize(glm::vec3(1, 0.3f, 0));
    EXPECT_NEAR(light.reflected(up, slanting, 0.1f).y, 1.2f + slanting.y, 0.02f) << "all of a narrow lobe lies above";
}

TEST(MapsExample, StandsInTheReadmeAsItIs) {
    const std::filesystem::path tests = KOKAGE_TESTS_FOLDER;
    const std::string example = read_text(tests / "unit/reflection/example/glossy_light.h");
    const std::string readme = read_text(tests.parent_path() / "reflection/README.md");
    ASSERT_FALSE(example.empty());
    const std::string code = example.substr(example.find("#include"));
    EXPECT_NE(readme.find("```cpp\n" + code + "```"), std::string::npos)
        << "copy tests/unit/reflection/example/glossy_light.h into reflection/README.md";
}

} // namespace
} // namespace kokage
