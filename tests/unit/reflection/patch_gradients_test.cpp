#include "common/services/random.h"
#include "reflection/patch_gradients.h"

#include <cmath>
#include <gtest/gtest.h>

namespace kokage::test {
namespace {

/// Rays from a square of a side in the plane y = height.
template <typename Light>
PatchMoments moments_of(int rays, float side, float height, const Light& light) {
    Random random(7, 0);
    PatchMoments moments({0, height, 0});
    for (int k = 0; k < rays; ++k) {
        const glm::vec3 point(side * random.uniform(), height, side * random.uniform());
        moments.add(point, light(point, random));
    }
    return moments;
}

TEST(PatchGradients, FindAStraightSlopeAtAnySizeAndPlace) {
    for (const float side : {1e-4f, 1.f, 1e3f})
        for (const float height : {0.f, 1e3f * side}) {
            const auto light = [&](const glm::vec3& p, Random&) { return 2 + 1.5f * (p.x - p.z) / side; };
            const PatchGradient gradient = moments_of(500, side, height, light).gradient();
            for (const glm::vec2 at : {glm::vec2(0.1f, 0.2f), glm::vec2(0.5f, 0.5f), glm::vec2(0.9f, 0.6f)}) {
                const glm::vec3 point(side * at.x, height, side * at.y);
                Random unused(1, 1);
                EXPECT_NEAR(gradient.at(point), light(point, unused) / 2, 0.1) << side << " " << height;
            }
        }
}

TEST(PatchGradients, FewNoisyRaysTellNoSlopeAndManyDo) {
    const auto noisy = [](const glm::vec3& p, Random& random) {
        return (1 + 0.4f * (p.x - 0.5f)) * -std::log(1 - random.uniform());
    };
    const PatchGradient few = moments_of(5, 1, 0, noisy).gradient(), many = moments_of(20000, 1, 0, noisy).gradient();
    EXPECT_NEAR(few.at({1, 0, 0.5f}), 1, 0.15);
    EXPECT_NEAR(many.at({1, 0, 0.5f}) - many.at({0, 0, 0.5f}), 0.4, 0.06);
}

TEST(PatchGradients, KeepTheMeanOfTheirRays) {
    double sum = 0;
    int count = 0;
    const auto light = [](const glm::vec3& p, Random& random) { return p.x + random.uniform(); };
    const PatchGradient gradient = moments_of(300, 1, 0, light).gradient();
    moments_of(300, 1, 0, [&](const glm::vec3& p, Random& random) {
        sum += double(gradient.at(p));
        ++count;
        return random.uniform(); // the same points again
    });
    EXPECT_NEAR(sum / count, 1, 1e-5);
}

TEST(PatchGradients, StayFiniteAndWithinBounds) {
    EXPECT_EQ(PatchMoments({0, 0, 0}).gradient().at({5, 5, 5}), 1.f);
    for (const float light : {0.f, 1e-38f, 1e30f}) {
        PatchMoments one_place({1, 2, 3}), line({0, 0, 0});
        for (int k = 0; k < 10; ++k) {
            one_place.add({1, 2, 3}, light);
            line.add({float(k), 0, 0}, light * float(k));
        }
        for (const PatchMoments& moments : {one_place, line})
            for (const float far : {0.f, 1.f, 1e20f}) {
                const float factor = moments.gradient().at({far, far, far});
                EXPECT_TRUE(factor >= 0.3f && factor <= 2.5f) << light << " " << far << " " << factor;
            }
    }
}

TEST(PatchGradients, OfManyPlacesOnlyThoseThatWereSetVary) {
    PatchGradients gradients;
    EXPECT_EQ(gradients.at(3, {9, 9, 9}), 1.f);
    gradients.set(10, 3, {{0, 0, 0}, {0.5f, 0, 0}});
    EXPECT_FLOAT_EQ(gradients.at(3, {1, 0, 0}), 1.5f);
    EXPECT_EQ(gradients.at(4, {1, 0, 0}), 1.f);
}

} // namespace
} // namespace kokage::test
