#include "common/environment/lat_long.h"
#include "common/services/random.h"
#include "reflection/gloss.h"
#include "reflection/glossy_light.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

Environment smooth_sky(int width) {
    Environment environment;
    environment.remainder = Image(width, width / 2, 3);
    for (int y = 0; y < width / 2; ++y)
        for (int x = 0; x < width; ++x) {
            const glm::dvec3 d = pixel_direction(x, y, width, width / 2);
            for (int c = 0; c < 3; ++c)
                environment.remainder.at(x, y)[c] = float(1 + 0.6 * d.y + 0.3 * d.x * d.z * (c + 1));
        }
    return environment;
}

TEST(GlossyRemainder, MirrorsShowTheImageWithoutItsPixels) {
    const Environment environment = smooth_sky(256);
    WorkReport report;
    const GlossyRemainder remainder(environment, kLeastRoughness, 0.3f, silent_progress(), report);
    EXPECT_LT(remainder.bytes(), 20e6) << "as fine as the image, not as the lobe";
    EXPECT_TRUE(std::any_of(report.skips.begin(), report.skips.end(), [](const WorkReport::Skip& skip) {
        return skip.what.starts_with("lobes narrower than of roughness");
    }));
    Random random(3);
    for (int i = 0; i < 2000; ++i) {
        const float height = 0.05f + 0.9f * float(random.uniform()), around = 2 * kPi * float(random.uniform());
        const float across = std::sqrt(1 - height * height);
        const glm::vec3 mirrored(across * std::cos(around), height, across * std::sin(around));
        const glm::vec3 seen = remainder.radiance(mirrored, mirrored, kLeastRoughness),
                        truth = lat_long_radiance(environment.remainder, mirrored);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(seen[c], truth[c], 0.02f * truth[c]) << glm::length(mirrored);
    }
}

TEST(GlossyRemainder, LeavesNoLobeOutThatTheImageCanTell) {
    WorkReport report;
    const GlossyRemainder remainder(smooth_sky(256), 0.3f, 0.6f, silent_progress(), report);
    for (const WorkReport::Skip& skip : report.skips)
        EXPECT_EQ(skip.what.find("lobes narrower"), std::string::npos) << skip.what;
}

} // namespace
} // namespace kokage
