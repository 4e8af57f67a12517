// What patches of few rays take from each other, and that none of their light is won or lost.
#include "reflection/lobe_prior.h"

#include "common/services/random.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

/// A patch under an open sky of 1 whose rays each find nothing, or the sky, with chance `open`.
GatheredLobe noisy_lobe(Random& random, int rays, float open, std::uint32_t look = 0) {
    GatheredLobe lobe;
    lobe.look = look;
    for (int ray = 0; ray < rays; ++ray) {
        lobe.open += glm::vec3(1, 2, 0);
        // A ray counts by what its direction is worth: noise that may make a patch's sum negative.
        if (random.uniform() >= open)
            lobe.correction -= 2 * random.uniform() * glm::vec3(1, 2, 0);
        ++lobe.weight;
    }
    return lobe;
}

glm::dvec3 mean_light(const LobePrior& prior, std::span<const GatheredLobe> lobes) {
    glm::dvec3 sum(0.);
    double weight = 0;
    for (const GatheredLobe& lobe : lobes) {
        const glm::vec3 light = prior.light(lobe);
        EXPECT_GE(std::min({light.x, light.y, light.z}), 0);
        sum += double(lobe.weight) * glm::dvec3(light);
        weight += double(lobe.weight);
    }
    return sum / weight;
}

/// As the rays themselves say.
glm::dvec3 mean_of_rays(std::span<const GatheredLobe> lobes) {
    glm::dvec3 sum(0.);
    double weight = 0;
    for (const GatheredLobe& lobe : lobes) {
        sum += glm::dvec3(lobe.open + lobe.correction);
        weight += double(lobe.weight);
    }
    return sum / weight;
}

TEST(LobePrior, NoLightIsWonWherePatchesOfFewRaysAreDarker) {
    Random random(1, 0);
    std::vector<GatheredLobe> lobes;
    for (int k = 0; k < 2000; ++k) {
        lobes.push_back(noisy_lobe(random, 1, 0.1f)); // these peep out
        lobes.back().seen_share = 0.1f;
    }
    for (int k = 0; k < 2000; ++k)
        lobes.push_back(noisy_lobe(random, 1, 0.8f)); // and these are small
    for (int k = 0; k < 200; ++k)
        lobes.push_back(noisy_lobe(random, 40, 0.9f));
    const LobePrior prior(lobes);
    const std::span<const GatheredLobe> all(lobes), peeping = all.first(2000), small = all.subspan(2000, 2000),
                                                    large = all.last(200);
    for (const auto& group : {peeping, small, large})
        for (glm::length_t c = 0; c < 2; ++c) // by one mean for all, what peeps out: 5
            EXPECT_NEAR(mean_light(prior, group)[c] / mean_of_rays(group)[c], 1, 0.01);
    EXPECT_EQ(mean_light(prior, all).z, 0);
}

TEST(LobePrior, PatchesOfOneRayTakeMuchOfTheirLightFromEachOther) {
    Random random(2, 0);
    std::vector<GatheredLobe> lobes;
    for (int k = 0; k < 500; ++k)
        lobes.push_back(noisy_lobe(random, 1, 0.5f));
    for (int k = 0; k < 500; ++k)
        lobes.push_back(noisy_lobe(random, 1, 1, 1)); // of another look
    const LobePrior prior(lobes);
    double noise = 0, own_noise = 0;
    for (int k = 0; k < 500; ++k) {
        noise += std::pow(double(prior.light(lobes[std::size_t(k)]).x) - 0.5, 2) / 500;
        own_noise += std::pow(double(lobes[std::size_t(k)].open.x + lobes[std::size_t(k)].correction.x) - 0.5, 2) / 500;
    }
    EXPECT_LT(noise, 0.3 * own_noise);
    for (std::size_t k = 500; k < lobes.size(); ++k)
        EXPECT_NEAR(prior.light(lobes[k]).y, 2, 1e-5f);
}

} // namespace
} // namespace kokage
