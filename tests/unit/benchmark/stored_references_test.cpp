#include "tests/benchmark/benchmark_plan.h"
#include "tests/benchmark/find_reference.h"
#include "tests/benchmark/render_judge.h"
#include "tests/benchmark/render_plan.h"
#include "tests/benchmark/render_scenes.h"
#include "tests/benchmark/render_truth_hash.h"
#include "tests/support/temporary_folder.h"

#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>

namespace kokage {
namespace {

const std::filesystem::path kFolder = std::filesystem::path(KOKAGE_TESTS_FOLDER) / "benchmark" / "references";

/// Each stored reference belongs to the scene that it is named for: who changes a crown, a material or a sky must make
/// the references anew (kokage_make_references).
class StoredReference : public testing::TestWithParam<PlannedScene> {};

TEST_P(StoredReference, is_of_this_very_scene) {
    const BenchSceneName name = GetParam().name;
    const auto stored = load_reference(kFolder / reference_file_name(name));
    if (!stored)
        GTEST_SKIP() << "skipped: no reference of " << to_string(name) << " is stored";
    const char* data = std::getenv("KOKAGE_DATA");
    BenchScenes scenes(data ? data : "");
    if (const std::string reason = scenes.why_not(name); !reason.empty())
        GTEST_SKIP() << "skipped: " << reason;
    const BenchScene scene = scenes.make(name);
    EXPECT_EQ(stored->scene_hash, scene_hash(scene));
    ASSERT_EQ(stored->sides.size(), 2u * name.leaves);
    EXPECT_GT(stored->noise, 0.0);
    EXPECT_LT(stored->noise, 0.05);
}

std::string test_name(const testing::TestParamInfo<PlannedScene>& info) {
    std::string name = to_string(info.param.name);
    for (char& c : name)
        if (c == '-')
            c = '_';
    return name;
}

INSTANTIATE_TEST_SUITE_P(plan, StoredReference, testing::ValuesIn(benchmark_plan(false)), test_name);

/// Each stored truth of a picture belongs to the scene that it is named for, and path tracing as it is now agrees with
/// it: who changes a species, a material or the path tracer must make the truths anew (kokage_make_references ...
/// pictures).
TEST(StoredPictures, are_of_these_very_scenes_and_agree_with_path_tracing) {
    const char* data = std::getenv("KOKAGE_DATA");
    if (!data)
        GTEST_SKIP() << "skipped: the teapot is in the data folder (KOKAGE_DATA)";
    const RenderPlan plan = render_plan(true);
    const TemporaryFolder folder;
    for (const SceneDescription& description : render_scenes(plan.width, plan.height, data, folder.path())) {
        const PictureOptions judged = judged_pixels(plan, description.picture);
        const auto stored = load_reference(kFolder / truth_file_name(description.name, judged));
        if (!stored)
            GTEST_SKIP() << "skipped: no truth of " << description.name << " is stored";
        const AssembledScene scene = assemble_scene(description, silent_progress());
        ASSERT_EQ(stored->scene_hash, picture_hash(scene, judged)) << description.name;
        const PictureTruth truth =
            find_truth(scene, judged, description.name, {kFolder, folder.path(), 1}, silent_progress());
        RenderOptions options;
        options.method = RenderMethod::path_traced;
        options.picture = judged;
        options.picture.samples = 32;
        PictureRecord record;
        judge(render_scene(scene, options, silent_progress()).picture.radiance, truth, record);
        EXPECT_LT(std::abs(*record.bias), 0.01) << description.name; // some 0.3 % of noise
        EXPECT_LT(*record.mean_error, 0.2) << description.name;
    }
}

TEST(StoredReferences, are_small_enough_to_keep_in_the_repository) {
    if (!std::filesystem::exists(kFolder))
        GTEST_SKIP() << "skipped: no reference is stored";
    std::uintmax_t bytes = 0;
    for (const auto& file : std::filesystem::directory_iterator(kFolder))
        bytes += file.file_size();
    EXPECT_LT(bytes, 15u << 20);
}

} // namespace
} // namespace kokage
