#include "common/services/random.h"
#include "reflection/gather_prior.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kokage::test {
namespace {

double normal(Random& random) {
    return std::sqrt(-2 * std::log(1 - double(random.uniform()))) * std::cos(2 * kPiDouble * double(random.uniform()));
}

/// Places whose light is `ratio` times what was solved, give or take `spread`, told by rays of standard deviation
/// `noise`, both over the light.
struct Places {
    std::vector<PlaceSums> sums;
    std::vector<double> light;
    std::vector<std::uint32_t> classes;

    void add(std::uint32_t in_class, int count, int rays, double ratio, double spread, double noise, Random& random) {
        for (int p = 0; p < count; ++p) {
            const double solved = 0.5 + double(random.uniform()), truth = solved * (ratio + spread * normal(random));
            PlaceSums place;
            for (int k = 0; k < rays; ++k)
                place.add(1, glm::vec3(float(truth + noise * solved * normal(random))), glm::vec3(float(solved)), 0);
            sums.push_back(place);
            light.push_back(truth);
            classes.push_back(in_class);
        }
    }
    double error(std::size_t place, const GatherPrior& prior) const {
        const glm::vec3 solved = sums[place].solved / sums[place].weight;
        return double(corrected_light(solved, sums[place], prior).r) - light[place];
    }
};

TEST(GatherPrior, CountsSolvedLightForTheRaysThatItIsWorth) {
    Random random(5);
    Places places;
    places.add(0, 2000, 30, 1.1, 0.1, 1, random); // as good as 100 rays
    places.add(1, 2000, 30, 1.3, 0.4, 1, random); // as good as 6
    const auto priors = fit_gather_priors(places.sums, places.classes, 2, 2);
    EXPECT_NEAR(priors[0].ratio.g, 1.1, 0.01);
    EXPECT_NEAR(priors[1].ratio.g, 1.3, 0.02);
    EXPECT_NEAR(priors[0].rays, 100 * 1.1 * 1.1, 40); // both over the expected light, less what the classes lend
    EXPECT_NEAR(priors[1].rays, 6, 2);
    // Better than the rays alone, and than the solution alone.
    double both = 0, rays = 0, solved = 0;
    for (std::size_t p = 0; p < 2000; ++p) {
        both += std::abs(places.error(p, priors[0]));
        rays += std::abs(places.error(p, {glm::dvec3(1.1), 0}));
        solved += std::abs(places.error(p, {glm::dvec3(1.1), 1e9}));
    }
    EXPECT_LT(both, 0.65 * rays);
    EXPECT_LT(both, solved);
}

TEST(GatherPrior, LeavesPlacesUnlikeTheirClassToTheirOwnRays) {
    Random random(8);
    Places places;
    constexpr int kAlike = 2000, kUnlike = 20, kRays = 100;
    places.add(0, kAlike, kRays, 1, 0.03, 0.5, random);
    places.add(0, kUnlike, kRays, 1.5, 0, 0.5, random); // the knob of a lid
    const GatherPrior prior = fit_gather_priors(places.sums, places.classes, 1, 1)[0];
    GatherPrior unlimited = prior;
    unlimited.deviation = std::numeric_limits<double>::infinity();
    EXPECT_NEAR(prior.deviation, 0.5, 0.03);
    const auto error = [&](int begin, int count, const GatherPrior& of) {
        double sum = 0;
        for (int p = begin; p < begin + count; ++p)
            sum += std::abs(places.error(std::size_t(p), of)) / count;
        return sum;
    };
    EXPECT_GT(error(kAlike, kUnlike, unlimited), 0.1);
    EXPECT_LT(error(kAlike, kUnlike, prior), 0.5 * error(kAlike, kUnlike, unlimited));
    EXPECT_LT(error(0, kAlike, prior), 1.1 * error(0, kAlike, unlimited));
}

TEST(GatherPrior, HasRaysWithSharesOfCornersCountTheirNoiseOnce) {
    // Two places share every ray by halves: the mean over n such rays is as noisy as over n whole ones.
    Random random(6);
    std::vector<PlaceSums> sums;
    for (int p = 0; p < 2000; ++p) {
        PlaceSums place;
        const double truth = 1 + 0.2 * normal(random);
        for (int k = 0; k < 20; ++k)
            place.add(0.5f, glm::vec3(float(truth + normal(random))), glm::vec3(1.f), 0);
        sums.push_back(place);
    }
    const std::vector<std::uint32_t> classes(sums.size(), 0);
    EXPECT_NEAR(fit_gather_priors(sums, classes, 1, 1)[0].rays, 25, 8);
}

TEST(GatherPrior, StaysFiniteAndUsualWhereLittleIsKnown) {
    PlaceSums few, huge, black;
    few.add(1, glm::vec3(2.f), glm::vec3(1.f), 0);
    huge.add(1, glm::vec3(1e28f), glm::vec3(1.f), 0);
    black.add(1, glm::vec3(0.3f), glm::vec3(0.f), 0);
    const std::vector<PlaceSums> sums{few, huge, black};
    const std::vector<std::uint32_t> classes{0, 1, 2};
    const auto priors = fit_gather_priors(sums, classes, 3, 1);
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(priors[k].rays, 16);
        const glm::vec3 light = corrected_light(k == 2 ? glm::vec3(0.f) : glm::vec3(1.f), sums[k], priors[k]);
        EXPECT_TRUE(std::isfinite(light.r) && light.r > 0) << light.r;
    }
    EXPECT_FLOAT_EQ(corrected_light(glm::vec3(0.f), black, priors[2]).r, 0.3f);
    EXPECT_TRUE(fit_gather_priors({}, {}, 0, 1).empty());
}

} // namespace
} // namespace kokage::test
