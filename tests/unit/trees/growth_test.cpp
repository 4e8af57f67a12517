#include "common/services/error.h"
#include "common/services/parallel.h"
#include "tests/unit/trees/growth_shape.h"
#include "trees/growth.h"
#include "trees/growth/leaf_shape.h"
#include "trees/growth/sky_light.h"
#include "trees/patches.h"

#include <cstring>
#include <gtest/gtest.h>

namespace kokage {
namespace {

template <class T>
std::uint64_t hash_bytes(std::uint64_t hash, const std::vector<T>& values) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
    for (std::size_t i = 0; i < values.size() * sizeof(T); ++i)
        hash = (hash ^ bytes[i]) * 1099511628211ull;
    return hash;
}

std::uint64_t hash_of(const Tree& tree) {
    std::uint64_t hash = 14695981039346656037ull;
    for (const TreePart& part : tree.parts) {
        hash = hash_bytes(hash, part.positions);
        hash = hash_bytes(hash, part.normals);
        hash = hash_bytes(hash, part.uvs);
        hash = hash_bytes(hash, part.triangles);
        hash = hash_bytes(hash, part.triangle_patch);
    }
    for (const Branch& branch : tree.skeleton.branches)
        hash = hash_bytes(hash, branch.nodes);
    return hash_bytes(hash, tree.leaves);
}

GrowthParameters oak_with(int leaves, std::uint64_t seed = 1) {
    GrowthParameters parameters = oak_parameters();
    parameters.leaves = leaves;
    parameters.seed = seed;
    return parameters;
}

TEST(Growth, SameSeedGivesSameBytesWithAnyNumberOfThreads) {
    std::vector<std::uint64_t> hashes;
    for (const int threads : {1, 2, 5}) {
        set_thread_count(threads);
        hashes.push_back(hash_of(grow(oak_with(3000))));
    }
    set_thread_count(0);
    EXPECT_EQ(hashes[0], hashes[1]);
    EXPECT_EQ(hashes[0], hashes[2]);
    EXPECT_NE(hashes[0], hash_of(grow(oak_with(3000, 2)))) << "another seed is another tree";
}

TEST(Growth, EverySpeciesGivesTheSameBytesWithAnyNumberOfThreadsAndExactLeaves) {
    for (const Species& species : all_species())
        for (const int leaves : {1, 37, 2500}) {
            GrowthParameters parameters = species.parameters;
            parameters.leaves = leaves;
            std::vector<std::uint64_t> hashes;
            for (const int threads : {1, 3}) {
                set_thread_count(threads);
                const Tree tree = grow(parameters);
                EXPECT_EQ(tree.leaves.size(), std::size_t(leaves)) << species.name;
                EXPECT_TRUE(is_sound(tree)) << species.name << ", " << leaves;
                hashes.push_back(hash_of(tree));
            }
            EXPECT_EQ(hashes[0], hashes[1]) << species.name << ", " << leaves;
        }
    set_thread_count(0);
}

TEST(Growth, LeafCountIsExactAndEveryLeafHangsOnItsBranch) {
    for (const int leaves : {1, 2, 3, 7, 8, 20, 99, 1000, 5000, 30000}) {
        const Tree tree = grow(oak_with(leaves));
        ASSERT_EQ(tree.leaves.size(), std::size_t(leaves));
        ASSERT_TRUE(is_sound(tree)) << leaves;
        const TreePart& foliage = tree.parts[1];
        EXPECT_EQ(foliage.kind, TreePartKind::foliage);
        EXPECT_EQ(foliage.triangles.size() % tree.leaves.size(), 0u);
        EXPECT_TRUE(std::is_sorted(foliage.triangle_patch.begin(), foliage.triangle_patch.end()));
        EXPECT_EQ(foliage.triangle_patch.back() + 1, std::uint32_t(leaves));
        for (const Leaf& leaf : tree.leaves) {
            float nearest = 1e30f;
            for (const Branch::Node& node : tree.skeleton.branches[std::size_t(leaf.branch)].nodes)
                nearest = std::min(nearest, glm::distance(node.position, leaf.centre));
            ASSERT_LT(nearest, 0.2f);
        }
    }
}

TEST(Growth, GenerationsAreNumberedFromTheTrunk) {
    const Tree tree = grow(oak_with(5000));
    const auto& branches = tree.skeleton.branches;
    EXPECT_EQ(branches[0].parent, -1);
    EXPECT_EQ(branches[0].order, 0);
    EXPECT_EQ(branches[0].nodes[0].position, glm::vec3(0.f));
    int highest = 0;
    for (std::size_t i = 1; i < branches.size(); ++i) {
        ASSERT_GE(branches[i].parent, 0) << "one trunk";
        ASSERT_LT(branches[i].parent, std::int32_t(i)) << "parents come first";
        const Branch& parent = branches[std::size_t(branches[i].parent)];
        ASSERT_EQ(branches[i].order, parent.order + 1);
        ASSERT_TRUE(std::any_of(parent.nodes.begin(), parent.nodes.end(), [&](const Branch::Node& node) {
            return node.position == branches[i].nodes[0].position;
        })) << "a branch begins at a node of its parent";
        highest = std::max(highest, branches[i].order);
    }
    EXPECT_GE(highest, 3);
    EXPECT_LE(highest, 9);
}

// Shinozaki et al. 1964, with exponent e: at every node, radius^e of what comes in is the sum of what goes on and what
// turns off.
TEST(Growth, RadiiFollowThePipeModel) {
    for (const double exponent : {2.0, 2.5}) {
        GrowthParameters parameters = oak_with(9000);
        parameters.pipe_exponent = exponent;
        const Tree tree = grow(parameters);
        const auto& branches = tree.skeleton.branches;
        const auto pipes = [&](float radius) { return std::pow(double(radius) / parameters.shoot_radius, exponent); };
        std::vector<std::vector<const Branch*>> children(branches.size());
        for (const Branch& branch : branches)
            if (branch.parent >= 0)
                children[std::size_t(branch.parent)].push_back(&branch);
        std::size_t checked = 0;
        for (std::size_t i = 0; i < branches.size(); ++i) {
            const auto& nodes = branches[i].nodes;
            // A branch's own shoot is its last two steps; they taper. Node 0 of a child stands on its parent.
            for (std::size_t k = branches[i].parent < 0 ? 0 : 1; k + 2 < nodes.size(); ++k) {
                double sum = k + 3 == nodes.size() ? 1.0 : pipes(nodes[k + 1].radius_m);
                for (const Branch* child : children[i])
                    if (child->nodes[0].position == nodes[k].position)
                        sum += pipes(child->nodes[0].radius_m);
                ASSERT_NEAR(pipes(nodes[k].radius_m), sum, 1e-4 * sum + 1e-3) << "branch " << i << ", node " << k;
                ++checked;
            }
        }
        EXPECT_GT(checked, 500u);
        EXPECT_NEAR(pipes(branches[0].nodes[0].radius_m), 9000 / parameters.leaves_per_shoot, 1.0)
            << "the trunk carries every shoot";
    }
}

// Shape of open-grown Quercus robur. Crown diameter over stem diameter: 24 to 27 for free-standing trees (Coombes et
// al. 2019, Urban Forestry & Urban Greening 44), less for old and stout ones (Hemery et al. 2005, Forest Ecology and
// Management 215). Leaf blades 7 to 14 cm. Leaf inclination of temperate broadleaves is about 20 to 50 degrees
// (Chianucci et al. 2018, Annals of Forest Science 75:50).
TEST(Growth, TheOakHasAnOaksProportions) {
    for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
        const Tree tree = grow(oak_with(30000, seed));
        const CrownShape crown = measure_crown(tree);
        EXPECT_GT(crown.width / crown.height, 1.0) << "broader than high";
        EXPECT_LT(crown.width / crown.height, 1.4);
        EXPECT_LT(crown.lowest_leaf / crown.height, 0.25) << "a short bole";
        EXPECT_GT(crown.widest_height, 0.3);
        EXPECT_LT(crown.widest_height, 0.75);
        EXPECT_NEAR(crown.leaf_area / crown.projection, oak_parameters().leaf_area_index, 0.6) << "as asked for";
        EXPECT_GT(crown.leaf_area / crown.projection, 3);
        EXPECT_LT(crown.leaf_area / crown.projection, 5.1);
        EXPECT_GT(crown.mean_inclination_degrees, 25);
        EXPECT_LT(crown.mean_inclination_degrees, 50);
        const double ratio = crown.width / (2 * tree.skeleton.branches[0].nodes[0].radius_m);
        EXPECT_GT(ratio, 16);
        EXPECT_LT(ratio, 27);
        int limbs = 0;
        for (const Branch& branch : tree.skeleton.branches)
            limbs +=
                branch.order == 1 && branch.nodes[0].radius_m > 0.15f * tree.skeleton.branches[0].nodes[0].radius_m;
        EXPECT_GE(limbs, 4) << "heavy limbs";
    }
}

TEST(Growth, ShapeStaysTheSameAsLeavesIncrease) {
    const CrownShape small = measure_crown(grow(oak_with(5000))), large = measure_crown(grow(oak_with(100000)));
    EXPECT_NEAR(large.width / small.width, std::sqrt(20.0), 0.15 * std::sqrt(20.0));
    EXPECT_NEAR(large.width / large.height, small.width / small.height, 0.15);
}

TEST(Growth, LeavesOfAllFormsHaveTheAreaThatWasReckonedWith) {
    for (const char* detail : {"kite", "lobed", "fine"}) {
        GrowthParameters parameters = oak_with(4000);
        set_parameter(parameters, "leaf_detail", detail);
        const Tree tree = grow(parameters);
        const CrownShape crown = measure_crown(tree);
        EXPECT_NEAR(crown.leaf_area / crown.projection, parameters.leaf_area_index, 0.9) << detail;
        for (const glm::uvec3& t : tree.parts[1].triangles)
            ASSERT_GT(triangle_area(tree.parts[1], t), 1e-9);
        for (const glm::vec2& uv : tree.parts[1].uvs) {
            ASSERT_GE(std::min(uv.x, uv.y), -1e-6f);
            ASSERT_LE(std::max(uv.x, uv.y), 1 + 1e-6f);
        }
    }
    GrowthParameters cards = oak_with(100);
    set_parameter(cards, "leaf_form", "alpha");
    const Tree tree = grow(cards);
    EXPECT_EQ(tree.parts[1].triangles.size(), 200u);
    ASSERT_TRUE(tree.materials[1].alpha_texture);
    // The mask shows the area that the crown's size was reckoned with.
    const PatchScene scene = make_patches(tree);
    const std::vector<double> areas = solid_areas(scene);
    double shown = 0;
    for (std::size_t i = 0; i < scene.leaf_count; ++i)
        shown += areas[i];
    EXPECT_NEAR(shown / 100, mean_leaf_area(cards), 0.08 * mean_leaf_area(cards));
    EXPECT_FALSE(grow(oak_with(100)).materials[1].alpha_texture);
}

TEST(Growth, FrontOfLeavesMostlyLooksUp) {
    const Tree tree = grow(oak_with(3000));
    int up = 0;
    for (std::size_t i = 0; i < tree.parts[1].triangles.size(); i += 8) {
        const glm::uvec3 t = tree.parts[1].triangles[i];
        const auto& p = tree.parts[1].positions;
        const glm::vec3 normal = glm::cross(p[t.y] - p[t.x], p[t.z] - p[t.x]);
        EXPECT_GT(glm::dot(normal, tree.parts[1].normals[t.y]), 0) << "normals stand on the counter-clockwise side";
        up += normal.y > 0;
    }
    EXPECT_GT(up, 2500);
}

TEST(Growth, MaterialsLetLightThroughAndConserveEnergy) {
    const Tree tree = grow(oak_with(50));
    for (const TreeMaterial& material : tree.materials) {
        EXPECT_GE(std::min({material.base_color.r, material.base_color.g, material.base_color.b}), 0.f);
        EXPECT_LE(std::max({material.base_color.r, material.base_color.g, material.base_color.b}), 1.f);
        if (material.base_color_texture)
            for (const float value : material.base_color_texture->pixels) {
                ASSERT_GE(value, 0.f);
                ASSERT_LE(value, 1.f);
            }
    }
    EXPECT_GT(tree.materials[1].diffuse_transmission, 0.f);
}

TEST(Growth, ParametersAreSetByNameAndRefusedWithAReason) {
    GrowthParameters parameters = oak_parameters();
    set_parameter(parameters, "leaves", "5000");
    set_parameter(parameters, "seed", "9007199254740991");
    set_parameter(parameters, "crown_base", "0.3");
    set_parameter(parameters, "leaf_form", "alpha");
    EXPECT_EQ(parameters.leaves, 5000);
    EXPECT_EQ(parameters.seed, 9007199254740991u);
    EXPECT_EQ(parameters.leaf_form, LeafForm::alpha);
    for (const auto& [name, value] : {std::pair("leaves", "0"),
                                      {"leaves", "2.5"},
                                      {"leaves", "many"},
                                      {"leaves", ""},
                                      {"leaves", "12x"},
                                      {"leaf_length", "nan"},
                                      {"leaf_length", "-1"},
                                      {"leaf_form", "square"},
                                      {"seed", "-1"}})
        EXPECT_THROW(set_parameter(parameters, name, value), InputError) << name << " = " << value;
    try {
        set_parameter(parameters, "leaf_lenght", "0.1");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("leaf_length"), std::string::npos) << error.what();
    }
    parameters.shoot_length = std::nan("");
    EXPECT_THROW(grow(parameters), InputError);
    EXPECT_THROW(find_species("triffid"), InputError);
    EXPECT_EQ(find_species("OAK").name, "oak");
}

TEST(Growth, EveryParameterIsDescribedAndItsTextSetsIt) {
    for (const Species& species : all_species()) {
        const std::vector<ParameterDescription> before = parameter_descriptions(species.parameters);
        for (const ParameterDescription& description : before) {
            EXPECT_FALSE(description.meaning.empty()) << description.name;
            EXPECT_LE(description.low, description.value) << description.name;
            EXPECT_GE(description.high, description.value) << description.name;
            GrowthParameters parameters = species.parameters;
            const double middle = description.whole ? std::floor(0.5 * (description.low + description.high))
                                                    : 0.5 * (description.low + description.high);
            const std::string text = description.choices.empty() ? std::to_string(middle) : description.choices.back();
            set_parameter(parameters, description.name, text);
            for (const ParameterDescription& after : parameter_descriptions(parameters))
                if (after.name == description.name)
                    EXPECT_NEAR(after.value, description.choices.empty() ? middle : description.high,
                                1e-6 * middle + 1e-6);
                else
                    EXPECT_EQ(after.value, std::find_if(before.begin(), before.end(), [&](const auto& b) {
                                               return b.name == after.name;
                                           })->value);
        }
    }
}

class CountingProgress : public Progress {
  public:
    void advance(std::size_t) override { ++advances; }
    bool stop_requested() const override { return advances >= 1; }
    int advances = 0;
};

// Twigs in shade die: with a high need of light leaves stand in more light, and none are lost.
TEST(Growth, ShadedTwigsAreShedAndTheirLeavesStandElsewhere) {
    GrowthParameters parameters = oak_with(20000);
    const auto centres = [&](double need) {
        parameters.light_need = need;
        std::vector<glm::vec3> places;
        for (const Leaf& leaf : grow(parameters).leaves)
            places.push_back(leaf.centre);
        EXPECT_EQ(places.size(), 20000u);
        return places;
    };
    const std::vector<glm::vec3> all = centres(0);
    const SkyLight light(all, 20000 * mean_leaf_area(parameters));
    const auto darkest_tenth = [&](const std::vector<glm::vec3>& places) {
        std::vector<float> lights;
        for (const glm::vec3& place : places)
            lights.push_back(light.relative(place));
        std::sort(lights.begin(), lights.end());
        return lights[lights.size() / 10];
    };
    const float before = darkest_tenth(all), some = darkest_tenth(centres(0.3)), few = darkest_tenth(centres(0.4));
    EXPECT_GT(some, 1.02f * before);
    EXPECT_GT(few, 1.05f * some);
}

// In closed forest the twigs low down of trees that are leafy to the ground get less light than they need: crowns are
// raised.
TEST(Growth, NeighboursClearTheBole) {
    const auto crown_base = [](GrowthParameters p, double stand) {
        p.leaves = 10000;
        p.stand = stand;
        std::vector<float> heights;
        for (const Leaf& leaf : grow(p).leaves)
            heights.push_back(leaf.centre.y);
        EXPECT_EQ(heights.size(), 10000u);
        std::nth_element(heights.begin(), heights.begin() + 1000, heights.end());
        return heights[1000];
    };
    for (const char* species : {"birch", "spruce"}) {
        GrowthParameters p = find_species(species).parameters;
        const double open = crown_base(p, 0), forest = crown_base(p, 1);
        EXPECT_GT(forest, 1.15 * open) << species;
        p.light_need = 0;
        EXPECT_NEAR(crown_base(p, 1), crown_base(p, 0), 1e-3) << species << ": light alone sheds";
    }
}

TEST(Growth, BranchesTurnUpDownAndToTheLightAsAsked) {
    GrowthParameters parameters = oak_with(6000);
    const auto mean_rise = [](const Tree& tree) {
        double rise = 0, length = 0;
        for (const Branch& branch : tree.skeleton.branches)
            if (branch.order >= 2)
                for (std::size_t i = 0; i + 1 < branch.nodes.size(); ++i) {
                    const glm::vec3 step = branch.nodes[i + 1].position - branch.nodes[i].position;
                    rise += step.y;
                    length += glm::length(step);
                }
        return rise / length;
    };
    parameters.branch_up = 0;
    const double level = mean_rise(grow(parameters));
    parameters.branch_up = 0.5;
    EXPECT_GT(mean_rise(grow(parameters)), level + 0.02);
    parameters.branch_up = -0.5;
    EXPECT_LT(mean_rise(grow(parameters)), level - 0.02);
    parameters.branch_up = 0;
    parameters.branch_to_light = 1;
    EXPECT_GT(mean_rise(grow(parameters)), level + 0.02) << "the sky is above";
    parameters.branch_to_light = 0;
    parameters.twig_sag = 120;
    EXPECT_LT(mean_rise(grow(parameters)), level - 0.1);
}

TEST(Growth, StopsWhenAsked) {
    CountingProgress progress;
    EXPECT_THROW(grow(oak_with(1000), progress), Stopped);
}

} // namespace
} // namespace kokage
