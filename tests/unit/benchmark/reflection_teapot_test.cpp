// The paper's table 4, small: what must come out of it whatever the size of the picture.
#include "common/scene/image_file.h"
#include "tests/benchmark/reflection_teapot.h"
#include "tests/support/temporary_folder.h"

#include <cstdlib>
#include <gtest/gtest.h>
#include <map>

using namespace kokage;

namespace {

TEST(ReflectionTeapot, ShellsMeetTheTargetAndBeatThePapersForm) {
    const char* data = std::getenv("KOKAGE_DATA");
    if (!data)
        GTEST_SKIP() << "skipped: the teapot is in the data folder; set KOKAGE_DATA";
    TeapotSettings settings;
    settings.data_folder = data;
    const TemporaryFolder folder;
    settings.pictures = folder.path();
    settings.width = 96;
    settings.height = 72;
    settings.cube_size = 32;
    settings.quick = true;
    std::map<std::string, std::map<std::string, ReflectionRecord>> records; // by case, by method
    measure_teapot(settings, [&](const ReflectionRecord& record) {
        const std::string name = record.environment + (record.smoothness ? " 0.25" : " mixed");
        EXPECT_TRUE(records[name].emplace(record.method, record).second) << name << " " << record.method;
    });
    ASSERT_EQ(records.size(), 4u);
    for (const auto& [name, of_methods] : records) {
        const auto mean = [&](const char* method) { return of_methods.at(method).mean_error_255.value(); };
        EXPECT_LT(mean("shells"), 0.2) << name;
        EXPECT_LT(mean("exact-lookup"), 0.05) << name;
        EXPECT_LT(mean("shells"), mean("shells-uncorrected")) << name;
        EXPECT_LT(mean("shells"), mean("cube-paper")) << name;
        EXPECT_GT(of_methods.at("shells-uncorrected").max_error_255.value(), 10) << name;
        EXPECT_EQ(of_methods.contains("shells-vertex"), name.ends_with("mixed"));
        EXPECT_EQ(of_methods.at("cube").size, 32);
        EXPECT_GT(of_methods.at("shells").bytes.value(), 1000);
    }
    const Image picture = load_image(folder / "teapot-pattern-mixed.png");
    EXPECT_EQ(picture.width, 4 * 96);
    EXPECT_EQ(picture.height, 72);
    EXPECT_EQ(folder.files().size(), 4u);
}

} // namespace
