#include "common/services/random.h"
#include "common/services/stopwatch.h"
#include "tests/unit/trees/growth_shape.h"
#include "trees/growth.h"
#include "trees/patches.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

TEST(GrowthStress, AMillionLeavesOfEverySpeciesGrowExactlyAndFinite) {
    for (const Species& species : all_species()) {
        GrowthParameters parameters = species.parameters;
        parameters.leaves = 1000000;
        parameters.leaf_form = LeafForm::alpha; // fewest triangles: this is about wood, counts and memory
        const Stopwatch watch;
        const Tree tree = grow(parameters);
        RecordProperty("cpu_seconds_of_" + species.name, std::to_string(watch.cpu()));
        EXPECT_LT(watch.cpu(), 60.0) << species.name;
        EXPECT_EQ(tree.leaves.size(), 1000000u) << species.name;
        EXPECT_TRUE(is_sound(tree)) << species.name;
    }
}

TEST(GrowthStress, EveryParameterAtItsEndsGrowsASoundTree) {
    for (const int leaves : {1, 40, 700})
        for (const ParameterDescription& description : parameter_descriptions(oak_parameters()))
            for (const bool high : {false, true}) {
                if (description.name == "leaves")
                    continue;
                GrowthParameters parameters = oak_parameters();
                parameters.leaves = leaves;
                const double value = high ? description.high : description.low;
                if (description.choices.empty()) {
                    std::string text(64, ' ');
                    text.resize(std::size_t(std::snprintf(text.data(), text.size(), "%.17g", value)));
                    set_parameter(parameters, description.name, text);
                } else {
                    set_parameter(parameters, description.name,
                                  high ? description.choices.back() : description.choices.front());
                }
                const Tree tree = grow(parameters);
                EXPECT_EQ(tree.leaves.size(), std::size_t(leaves)); // the ends of `season` bear leaves or flowers
                EXPECT_TRUE(is_sound(tree)) << description.name << " = " << value << ", " << leaves << " leaves";
                EXPECT_NO_THROW(validate(make_patches(tree)));
            }
}

TEST(GrowthStress, RandomParametersGrowSoundTrees) {
    for (std::uint64_t trial = 0; trial < 120; ++trial) {
        Random random(17, trial);
        GrowthParameters parameters = oak_parameters();
        std::string text;
        for (const ParameterDescription& description : parameter_descriptions(parameters)) {
            const double value = description.low + (description.high - description.low) * random.uniform_double();
            const double rounded = description.whole ? std::floor(value) : value;
            std::string number = std::to_string(rounded);
            if (description.name == "leaves")
                number = std::to_string(1 + random.below(1500));
            else if (!description.choices.empty())
                number = description.choices[std::size_t(rounded)];
            set_parameter(parameters, description.name, number);
            text += description.name + "=" + number + " ";
        }
        const Tree tree = grow(parameters);
        ASSERT_TRUE(is_sound(tree)) << text;
    }
}

} // namespace
} // namespace kokage
