#include "common/directions/lobes.h"
#include "common/services/random.h"
#include "reflection/gloss.h"

#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

TEST(Gloss, LobeIsDrawnWithItsDensity) {
    const glm::vec3 mirrored = glm::normalize(glm::vec3(0.3f, 0.8f, -0.5f));
    for (const float roughness : {0.05f, 0.3f, 0.7f, 1.f}) {
        Random random(5);
        double mass = 0, weights = 0, most = 0;
        constexpr int kCount = 200000;
        for (int k = 0; k < kCount; ++k) {
            const LobeSample drawn = sample_gloss(mirrored, roughness, {random.uniform(), random.uniform()});
            ASSERT_NEAR(glm::length(drawn.direction), 1, 1e-5);
            ASSERT_NEAR(gloss_density(mirrored, roughness, drawn.direction), drawn.density, 2e-3 * drawn.density + 1e-6)
                << roughness;
            weights += drawn.weight;
            most = std::max(most, double(drawn.weight));
            mass += drawn.weight * (glm::dot(drawn.direction, mirrored) > 0.9f);
        }
        EXPECT_NEAR(weights / kCount, 1, 5e-3) << roughness;
        EXPECT_LE(most, 2.0001) << roughness;
        // Within a cone, against the integral of the lobe's value.
        double expected = 0;
        constexpr int kSteps = 100000;
        for (int k = 0; k < kSteps; ++k) {
            const double w = 0.1 * (k + 0.5) / kSteps;
            expected += 2 * kPiDouble * 0.1 / kSteps * ggx_lobe_value(roughness, 2 * w);
        }
        EXPECT_NEAR(mass / kCount, expected, 5e-3) << roughness;
    }
}

TEST(Gloss, MeanReflectanceIsTheIntegralOfFresnels) {
    const glm::vec3 normal_reflectance(0.04f, 0.3f, 0.9f);
    for (const float roughness : {0.f, 0.4f, 1.f}) {
        glm::dvec3 sum(0.);
        constexpr int kSteps = 20000;
        for (int k = 0; k < kSteps; ++k) {
            const float cosine = (float(k) + 0.5f) / kSteps;
            sum += 2. * double(cosine) / kSteps * glm::dvec3(gloss_reflectance(normal_reflectance, roughness, cosine));
        }
        const glm::vec3 mean = mean_gloss_reflectance(normal_reflectance, roughness);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(mean[c], sum[c], 1e-4);
    }
}

} // namespace
} // namespace kokage
