#include "trees/growth.h"

#include "common/services/stopwatch.h"
#include "trees/growth/bark.h"
#include "trees/growth/crown.h"
#include "trees/growth/leaf_shape.h"
#include "trees/growth/leaves.h"
#include "trees/growth/materials.h"
#include "trees/growth/skeleton.h"
#include "trees/growth/wood_graph.h"
#include "trees/growth/young_tree.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

/// Steps, reach and kill distance of space colonisation, as shares of the attraction points' spacing. A kill distance
/// of about two steps lets a branch end within reach of its leaves (Runions et al. 2007, section 3).
constexpr float step_share = 0.36f, influence_share = 4.5f, kill_share = 0.75f;
/// Shoots that one attraction point stands for.
constexpr double shoots_per_point = 2.2;

/// Trees of the same kind and height that cover a share of the ground around.
Neighbours neighbours_of(const Crown& crown, const GrowthParameters& p) {
    return {p.stand * p.leaf_area_index / std::max(1e-6, double(crown.height_m - crown.base_m)), crown.base_m,
            crown.height_m};
}

} // namespace

Tree grow(const GrowthParameters& grown_parameters, Progress& progress, WorkReport* report) {
    check_parameters(grown_parameters);
    const GrowthParameters parameters = at_its_age(grown_parameters);
    Stopwatch watch;
    auto end_stage = [&](const char* name) {
        if (report)
            report->stages.push_back({name, watch.cpu(), watch.wall()});
        watch.restart();
        progress.advance(1);
        progress.throw_if_stopped();
    };
    progress.begin("growing " + parameters.species, 3);
    Tree tree;
    tree.name = parameters.species;
    tree.source = "grown: " + parameters.species + ", seed " + std::to_string(parameters.seed);
    const Crown crown(parameters);
    const int point_count = std::max(
        1, int(std::lround(parameters.leaves / leaves_on_a_shoot(parameters, crown.height_m) / shoots_per_point)));
    const float spacing = crown.spacing_m(point_count), step = step_share * spacing;
    Scaffold scaffold = grow_scaffold(parameters, crown, step);
    const std::vector<glm::vec3> points = crown.attractors(point_count, scaffold.limbs);
    const SkyLight light(points, parameters.leaves * mean_leaf_area(parameters), neighbours_of(crown, parameters));
    std::vector<WoodNode> wood = std::move(scaffold.nodes);
    colonise(wood, points, light, parameters, {step, influence_share * spacing, kill_share * spacing}, progress);
    GrownSkeleton grown = make_skeleton(std::move(wood), light, crown.height_m, parameters);
    end_stage("skeleton");
    tree.parts.resize(2);
    const std::vector<Tube> tubes = make_tubes(grown.skeleton, parameters);
    std::vector<BarkPlace> places;
    TreePart all_bark;
    tree.bark_patch_count = make_bark(tubes, parameters, all_bark, &places);
    BarkInZones bark = split_by_zone(all_bark, places, parameters);
    tree.materials.push_back(bark_material(parameters, bark.zones[0]));
    tree.parts[0] = std::move(bark.parts[0]);
    end_stage("bark");
    tree.materials.push_back(leaf_material(parameters));
    tree.parts[1].material = 1;
    make_leaves(grown, parameters, {0, crown.widest_m, 0}, tree.parts[1], tree.leaves);
    // Part 0 is the foot's bark, part 1 the leaves; other zones of bark follow.
    for (std::size_t zone = 1; zone < bark.zones.size(); ++zone) {
        tree.parts.push_back(std::move(bark.parts[zone]));
        tree.parts.back().material = std::uint32_t(tree.materials.size());
        tree.materials.push_back(bark_material(parameters, bark.zones[zone]));
    }
    tree.skeleton = std::move(grown.skeleton);
    move_to_centre_lines(tree.skeleton, tubes);
    end_stage("leaves");
    return tree;
}

} // namespace kokage
