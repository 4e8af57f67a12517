// The exact tracer's answers and reads with every instruction set.
#include "reflection/relief/exact_tracer.h"
#include "tests/support/instruction_sets.h"
#include "tests/support/random_relief.h"
#include "tests/support/relief_rays.h"

using namespace kokage;

namespace {

TEST(ReliefInstructionSets, ExactHitsAreTrueAndReadTheSame) {
    for (const ReliefMap map : {ReliefMap::bark, ReliefMap::spikes}) {
        const HeightField field = make_relief_map(map, 128, 96);
        const std::vector<ReliefRay> rays = view_rays(5000, 31);
        const auto tracer = make_exact_tracer(field);
        std::vector<double> reads;
        test::with_every_instruction_set([&] {
            std::vector<ReliefHit> hits(rays.size());
            tracer->trace(rays, hits);
            const WrongHits wrong = wrong_hits(field, rays, hits);
            EXPECT_LE(wrong.count, 1u) << relief_map_name(map); // a tie
            EXPECT_LT(wrong.worst_right, 0.05);
            reads.push_back(wrong.reads_mean);
        });
        for (const double mean : reads) // rounding may take another node
            EXPECT_NEAR(mean, reads[0], 0.01);
    }
}

TEST(ReliefInstructionSets, ExactFindsAndMissesTheSameOnOddFields) {
    Random random(32);
    for (int map = 0; map < 60; ++map) {
        const HeightField field = random_height_field(random);
        std::vector<ReliefRay> rays;
        for (int k = 0; k < 30; ++k)
            rays.push_back(random_relief_ray(random, field));
        const auto tracer = make_exact_tracer(field);
        test::with_every_instruction_set([&] {
            std::vector<std::uint8_t> hidden(rays.size());
            tracer->occluded(rays, hidden);
            for (std::size_t k = 0; k < rays.size(); ++k) {
                EXPECT_EQ(hidden[k] != 0, true_relief_hit(field, rays[k]).found()) << "map " << map << ", ray " << k;
            }
        });
    }
}

} // namespace
