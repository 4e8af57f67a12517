#include "trees/growth/parameter_table.h"

namespace kokage {
namespace {

using P = GrowthParameters;

std::vector<ParameterRow> grouped(const char* group, std::vector<ParameterRow> rows) {
    for (ParameterRow& row : rows)
        row.description.group = group;
    return rows;
}

std::vector<ParameterRow> tree_rows() {
    ParameterRow seed =
        real("seed", nullptr, "", 0, 9007199254740992.0, "Which individual: the same seed gives the same tree.");
    seed.description.whole = true;
    seed.get = [](const P& p) { return double(p.seed); };
    seed.set = [](P& p, double v) { p.seed = std::uint64_t(v); };
    return grouped("tree", {seed, whole("leaves", &P::leaves, "", 1, 2000000,
                                        "Number of leaves; the tree's size follows from it.")});
}

std::vector<ParameterRow> crown_rows() {
    return grouped(
        "crown",
        {real("leaf_area_index", &P::leaf_area_index, "m2 per m2", 0.2, 20,
              "Leaf area over the crown's ground projection; sets the crown's width for a number of leaves."),
         real("height_to_width", &P::height_to_width, "", 0.3, 6, "Height of the tree over the width of its crown."),
         real("crown_base", &P::crown_base, "of the height", 0, 0.9, "Where the crown begins."),
         real("crown_widest", &P::crown_widest, "of the crown's depth", 0.02, 0.98,
              "Where the crown is widest, from its base."),
         real("crown_bottom", &P::crown_bottom, "of the widest radius", 0, 0.99, "Radius of the crown at its base."),
         real("crown_roundness", &P::crown_roundness, "", 1, 6, "1: a cone, 2: an ellipsoid, above: boxier."),
         whole("crown_lobes", &P::crown_lobes, "", 0, 400, "Number of billows on the crown's surface."),
         real("crown_lobe_depth", &P::crown_lobe_depth, "of the radius", 0, 0.7,
              "Depth of the hollows between the billows."),
         real("crown_shell", &P::crown_shell, "", 0, 12,
              "How much foliage keeps to the outside of the crown; 0: even."),
         real("crown_clumping", &P::crown_clumping, "", 0, 1, "Share of the foliage that gathers in clumps.")});
}

std::vector<ParameterRow> trunk_rows() {
    return grouped(
        "trunk and limbs",
        {real("trunk_reach", &P::trunk_reach, "of the height", 0.05, 0.98, "How high the trunk can be followed."),
         real("trunk_wiggle", &P::trunk_wiggle, "degrees", 0, 60, "How far the trunk's direction wanders."),
         whole("limbs", &P::limbs, "", 0, 60, "Number of main limbs on the trunk."),
         real("limb_first", &P::limb_first, "of the height", 0.01, 0.95, "Where the lowest limb leaves the trunk."),
         real("limb_last", &P::limb_last, "of the height", 0.01, 0.98, "Where the highest limb leaves the trunk."),
         real("limb_elevation_low", &P::limb_elevation_low, "degrees", -60, 89,
              "Angle of the lowest limb above the horizontal."),
         real("limb_elevation_high", &P::limb_elevation_high, "degrees", -60, 89,
              "Angle of the highest limb above the horizontal."),
         real("limb_zigzag", &P::limb_zigzag, "degrees", 0, 80, "How sharply limbs bend at their knees."),
         real("limb_reach", &P::limb_reach, "of the way", 0.05, 1,
              "How far a limb keeps its course towards the crown's surface.")});
}

std::vector<ParameterRow> branch_rows() {
    return grouped(
        "branches and bark",
        {real("branch_zigzag", &P::branch_zigzag, "degrees", 0, 60, "How much finer branches wander."),
         real("branch_up", &P::branch_up, "", -1, 1, "How strongly finer branches turn upwards."),
         real("pipe_exponent", &P::pipe_exponent, "", 1.2, 4,
              "Pipe model: radius^e of a branch is the sum over its children; 2 keeps cross-sections.",
              "Shinozaki et al. 1964, Japanese Journal of Ecology 14"),
         real("root_flare", &P::root_flare, "of the radius", 0, 3, "How much the trunk widens at the ground."),
         real("bark_tile", &P::bark_tile, "m", 0.02, 10, "Size of one tile of bark texture on the trunk.")});
}

} // namespace

std::vector<ParameterRow> wood_rows() {
    std::vector<ParameterRow> rows;
    for (auto* group : {tree_rows, crown_rows, trunk_rows, branch_rows}) {
        const std::vector<ParameterRow> more = group();
        rows.insert(rows.end(), more.begin(), more.end());
    }
    return rows;
}

} // namespace kokage
