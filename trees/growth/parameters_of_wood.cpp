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
    return grouped(
        "tree",
        {seed, whole("leaves", &P::leaves, "", 1, kMostLeaves, "Number of leaves; the tree's size follows from it."),
         whole("young_below", &P::young_below, "leaves", 0, kMostLeaves,
               "With fewer leaves it is a young tree: it has a leader, is slender and leafy far down, and its "
               "twigs don't hang; 0: never.")});
}

std::vector<ParameterRow> crown_rows() {
    return grouped(
        "crown",
        {real("leaf_area_index", &P::leaf_area_index, "m2 per m2", 0.2, 60,
              "Leaf area over the crown's ground projection; sets the crown's width for a number of leaves.",
              "Jonckheere et al. 2004, Agricultural and Forest Meteorology 121:19"),
         real("height_to_width", &P::height_to_width, "", 0.3, 12, "Height of the tree over the width of its crown."),
         real("crown_base", &P::crown_base, "of the height", 0, 0.9, "Where the crown begins."),
         real("crown_widest", &P::crown_widest, "of the crown's depth", 0.02, 0.98,
              "Where the crown is widest, from its base."),
         real("crown_bottom", &P::crown_bottom, "of the widest radius", 0, 0.99, "Radius of the crown at its base."),
         real("crown_roundness", &P::crown_roundness, "", 0.5, 6,
              "Its upper outline; 1: a cone, 2: an ellipsoid, above: flat-topped, below: hollow."),
         real("crown_underside", &P::crown_underside, "", 0.5, 6, "Its lower outline, in the same way."),
         whole("crown_lobes", &P::crown_lobes, "", 0, 400, "Number of billows on the crown's surface."),
         real("crown_lobe_depth", &P::crown_lobe_depth, "of the radius", 0, 0.7,
              "Depth of the hollows between the billows."),
         real("crown_shell", &P::crown_shell, "", 0, 12, "How much foliage keeps to the outside of the crown; 0: even.",
              "Runions et al. 2007, EG Workshop on Natural Phenomena: points that branches grow towards"),
         real("crown_clumping", &P::crown_clumping, "", 0, 1, "Share of the foliage that gathers in clumps."),
         real("crown_layers", &P::crown_layers, "", 0, 1,
              "Share of the foliage that spreads in level sheets around the limbs, so that tiers show."),
         real("layer_width", &P::layer_width, "of the limb's length", 0.01, 2, "Half the width of such a sheet."),
         real("layer_depth", &P::layer_depth, "of the limb's length", 0, 1, "Half its depth.")});
}

std::vector<ParameterRow> trunk_rows() {
    return grouped(
        "trunk and limbs",
        {real("trunk_reach", &P::trunk_reach, "of the height", 0.05, 1,
              "How high the trunk can be followed: near 1 for a tree with one leader (excurrent), 0.3 to 0.7 where it "
              "dissolves in limbs (decurrent).",
              "Brown et al. 1967, American Journal of Botany 54:153"),
         real("trunk_wiggle", &P::trunk_wiggle, "degrees", 0, 60, "How far the trunk's direction wanders."),
         whole("limbs", &P::limbs, "", 0, 400, "Number of main limbs on the trunk."),
         whole("limb_whorl", &P::limb_whorl, "", 1, 12,
               "Limbs that leave the trunk at one height: 1 alternate, 2 opposite, more: a whorl.",
               "Bell 2008, Plant Form: phyllotaxis"),
         real("limb_divergence", &P::limb_divergence, "degrees", 0, 360,
              "Turn around the trunk from one limb or whorl to the next; 137.5 is the golden angle, 90 crosses pairs.",
              "Bell 2008, Plant Form: phyllotaxis"),
         real("limb_first", &P::limb_first, "of the height", 0.01, 0.95, "Where the lowest limb leaves the trunk."),
         real("limb_last", &P::limb_last, "of the height", 0.01, 1, "Where the highest limb leaves the trunk."),
         real("limb_elevation_low", &P::limb_elevation_low, "degrees", -60, 89,
              "Angle of the lowest limb above the horizontal."),
         real("limb_elevation_high", &P::limb_elevation_high, "degrees", -60, 89,
              "Angle of the highest limb above the horizontal."),
         real("limb_bend", &P::limb_bend, "degrees", -120, 120,
              "How much limbs turn up (or, below 0, down) on their way."),
         real("limb_zigzag", &P::limb_zigzag, "degrees", 0, 80, "How sharply limbs bend at their knees."),
         real("limb_reach", &P::limb_reach, "of the way", 0.05, 1,
              "How far a limb keeps its course towards the crown's surface."),
         real("limb_bare", &P::limb_bare, "of the limb's length", 0, 0.95,
              "Inner part of a limb that bears no twigs.")});
}

std::vector<ParameterRow> branch_rows() {
    return grouped(
        "branches",
        {real("branch_angle", &P::branch_angle, "degrees", 5, 120,
              "Mean angle between a branch and the axis that it leaves."),
         real("branch_angle_spread", &P::branch_angle_spread, "degrees", 0, 60, "Branching angles vary by up to this."),
         real("apical_dominance", &P::apical_dominance, "", 0, 1,
              "How much the end of an axis keeps its lead: it runs straight, and branches beside it come late.",
              "Palubicki et al. 2009, ACM Transactions on Graphics 28(3) 58"),
         real("branch_up", &P::branch_up, "", -1, 1, "How strongly branches turn up, away from gravity; below 0: down.",
              "Palubicki et al. 2009, ACM Transactions on Graphics 28(3) 58"),
         real("branch_to_light", &P::branch_to_light, "", 0, 1,
              "How strongly branches turn to where the sky's light comes from.",
              "Palubicki et al. 2009, ACM Transactions on Graphics 28(3) 58"),
         real("branch_zigzag", &P::branch_zigzag, "degrees", 0, 60, "How much branches wander."),
         real("twig_sag", &P::twig_sag, "degrees", 0, 180,
              "How far thin wood turns down with every tenth of the tree's height that it is long."),
         real("light_need", &P::light_need, "of the open sky", 0, 0.9,
              "Twigs with less light than this die and are shed.", "Wiesner 1907, Der Lichtgenuss der Pflanzen"),
         real("stand", &P::stand, "of the ground", 0, 1,
              "Share of the ground around that other crowns of its kind cover: 0 for a tree in the open, 1 in closed "
              "forest, where twigs low down get less than light_need and the bole is bare.",
              "Monsi and Saeki 1953, Japanese Journal of Botany 14: light in a stand"),
         real("shoot_up", &P::shoot_up, "", -1, 1, "How strongly shoots turn up."),
         real("shoot_hang", &P::shoot_hang, "of the height", 0, 0.9,
              "Length of the longest hanging shoots of a weeping tree; 0: shoots don't hang."),
         real("pipe_exponent", &P::pipe_exponent, "", 1.2, 4,
              "Pipe model: radius^e of a branch is the sum over its children; 2 keeps cross-sections.",
              "Shinozaki et al. 1964, Japanese Journal of Ecology 14")});
}

std::vector<ParameterRow> bark_rows() {
    return grouped(
        "trunk's foot and bark",
        {real("root_flare", &P::root_flare, "of the radius", 0, 3, "How much the trunk widens at the ground."),
         real("bark_tile", &P::bark_tile, "m", 0.02, 10, "Size of one tile of bark texture on the trunk.")});
}

} // namespace

std::vector<ParameterRow> wood_rows() {
    std::vector<ParameterRow> rows;
    for (auto* group : {tree_rows, crown_rows, trunk_rows, branch_rows, bark_rows}) {
        const std::vector<ParameterRow> more = group();
        rows.insert(rows.end(), more.begin(), more.end());
    }
    return rows;
}

} // namespace kokage
