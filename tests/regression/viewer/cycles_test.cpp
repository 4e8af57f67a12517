// Our path tracer against a renderer that we did not write. The large check of three scenes: tests/README.md.
#include "tests/cycles/cross_check.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

TEST(Cycles, SendsTheSameLightToTheCamera) {
    if (const auto why = why_no_blender())
        GTEST_SKIP() << "skipped: " << *why;
    const TemporaryFolder folder;
    const CrossCheck check = cross_check(small_scene(), {.width = 96, .height = 96, .samples = 128}, folder.path());
    EXPECT_GT(check.coverage, 0.3);
    EXPECT_NEAR(check.coverage_difference, 0, 0.005);
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(check.difference[c], 0, 0.01) << "channel " << c << ", noise " << check.noise[c];
}

} // namespace
} // namespace kokage
