// The vector code that adds up the ends of lines against a scalar loop in double precision.
#include "foliage/bundles/end_gather.h"
#include "tests/support/instruction_sets.h"
#include "tests/unit/foliage/small_trees.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

using namespace bundles;

struct TwinSums {
    double weight = 0, front_open = 0, back_open = 0, front_down = 0, back_down = 0;
    glm::dvec3 front{0.0}, back{0.0};
};

TwinSums twin(const Facet& facet, std::size_t index, const std::vector<glm::vec3>& directions,
              const OpenFractions& open, const EndRadiance& radiance, std::size_t first, std::size_t last) {
    TwinSums sums;
    for (std::size_t i = first; i < last; ++i) {
        const int near_open = open.near_row(i)[index], far_open = open.far_row(i)[index];
        if (near_open == OpenFractions::kUnseen)
            continue;
        const double facing = glm::dot(glm::dvec3(facet.normal), glm::dvec3(directions[i]));
        const double projected = facet.bark ? double(facet.projected_share(directions[i])) : std::abs(facing);
        const double pixels = projected * facet.area * open.pixels_per_area;
        const double met = facet.masked ? 1 - std::exp(-(pixels + 0.3 * pixels * pixels)) : std::min(pixels, 1.0);
        const double weight = projected / met;
        const double near_weight = weight * near_open / 254, far_weight = weight * far_open / 254;
        const glm::dvec3 from_near = near_weight * glm::dvec3(radiance.near_end[i]),
                         from_far = far_weight * glm::dvec3(radiance.far_end[i]);
        sums.weight += weight;
        if (facet.bark) { // only its front is lit, from both ends
            sums.front_open += near_weight + far_weight;
            sums.front_down += far_weight;
            sums.front += from_near + from_far;
        } else if (facing < 0) {
            sums.front_open += near_weight;
            sums.back_open += far_weight;
            sums.back_down += far_weight;
            sums.front += from_near;
            sums.back += from_far;
        } else {
            sums.front_open += far_weight;
            sums.back_open += near_weight;
            sums.front_down += far_weight;
            sums.front += from_far;
            sums.back += from_near;
        }
    }
    return sums;
}

/// Facets of 0 to 4 pixels, runs of them masked, open shares and light at random; a tenth of the facets are not met by
/// a direction.
struct RandomEnds {
    Facets facets;
    LineDirections lines;
    OpenFractions open;
    EndRadiance radiance;

    RandomEnds(std::size_t leaves, std::size_t bark) {
        Random random(3);
        for (std::size_t f = 0; f < leaves + bark; ++f) {
            Facet facet;
            facet.bark = f >= leaves;
            facet.area = random.uniform(0.5f, 1);
            facet.masked = f < leaves && f / 70 % 3 == 1;
            const glm::vec3 n = test::random_direction(random), m = test::random_direction(random);
            facet.normal = facet.bark ? glm::vec3(0) : n;
            const glm::vec3 other = facet.bark ? m : n;
            const float moments[6] = {n.x * n.x + other.x * other.x, n.y * n.y + other.y * other.y,
                                      n.z * n.z + other.z * other.z, n.x * n.y + other.x * other.y,
                                      n.x * n.z + other.x * other.z, n.y * n.z + other.y * other.z};
            for (std::size_t i = 0; i < 6; ++i)
                facet.form[i] = 0.5f * moments[i];
            facets.facets.push_back(facet);
        }
        facets.leaf_facet_count = std::uint32_t(leaves);
        lines = make_line_directions(12, 5);
        open.facet_count = leaves + bark;
        open.pixels_per_area = 4;
        for (std::size_t i = 0; i < lines.directions.size(); ++i) {
            for (std::size_t f = 0; f < leaves + bark; ++f) {
                const bool unseen = random.below(10) == 0;
                open.near_end.push_back(unseen ? OpenFractions::kUnseen : std::uint8_t(random.below(255)));
                open.far_end.push_back(unseen ? OpenFractions::kUnseen : std::uint8_t(random.below(255)));
            }
            radiance.near_end.push_back({random.uniform(), 10 * random.uniform(), random.uniform()});
            radiance.far_end.push_back({random.uniform(), random.uniform(), 0});
        }
    }
};

void expect_same_as_twin(const RandomEnds& ends, std::size_t first, std::size_t last) {
    std::vector<EndSums> sums(ends.facets.facets.size());
    gather_ends(ends.facets, ends.lines.directions, ends.open, ends.radiance, first, last, sums);
    for (std::size_t f = 0; f < sums.size(); ++f) {
        const TwinSums expected =
            twin(ends.facets.facets[f], f, ends.lines.directions, ends.open, ends.radiance, first, last);
        // Single precision loses this much of 1 - exp(-x) and of the sums.
        constexpr double kClose = 3e-4;
        ASSERT_NEAR(sums[f].weight, expected.weight, kClose) << f;
        ASSERT_NEAR(sums[f].front_open, expected.front_open, kClose) << f;
        ASSERT_NEAR(sums[f].back_open, expected.back_open, kClose) << f;
        ASSERT_NEAR(sums[f].front_down, expected.front_down, kClose) << f;
        ASSERT_NEAR(sums[f].back_down, expected.back_down, kClose) << f;
        for (std::size_t c = 0; c < 3; ++c) {
            ASSERT_NEAR(sums[f].front[c], expected.front[c], 1e-3) << f;
            ASSERT_NEAR(sums[f].back[c], expected.back[c], 1e-3) << f;
        }
    }
}

TEST(BundlesEndGather, SumsAreThoseOfTheTwin) {
    for (const auto& [leaves, bark] :
         {std::pair<std::size_t, std::size_t>(1, 0), {0, 1}, {63, 2}, {64, 64}, {5000, 37}}) {
        SCOPED_TRACE(testing::Message() << leaves << " leaves, " << bark << " pieces of bark");
        expect_same_as_twin(RandomEnds(leaves, bark), 0, 12);
    }
}

TEST(BundlesEndGather, PartsOfTheDirectionsAddUp) {
    const RandomEnds ends(100, 20);
    expect_same_as_twin(ends, 3, 9);
    std::vector<EndSums> sums(120), all(120);
    gather_ends(ends.facets, ends.lines.directions, ends.open, ends.radiance, 0, 5, sums);
    gather_ends(ends.facets, ends.lines.directions, ends.open, ends.radiance, 5, 12, sums);
    gather_ends(ends.facets, ends.lines.directions, ends.open, ends.radiance, 0, 12, all);
    for (std::size_t f = 0; f < sums.size(); ++f)
        ASSERT_NEAR(sums[f].front[1], all[f].front[1], 1e-4);
}

TEST(BundlesEndGather, EveryInstructionSetAddsTheSame) {
    const RandomEnds ends(150, 50);
    test::with_every_instruction_set([&] { expect_same_as_twin(ends, 0, 12); });
}

} // namespace
} // namespace kokage
