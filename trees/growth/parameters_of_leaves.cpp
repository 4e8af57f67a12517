#include "trees/growth/parameter_table.h"

namespace kokage {

std::vector<ParameterRow> leaf_rows() {
    using P = GrowthParameters;
    std::vector<ParameterRow> rows = {
        real("leaves_per_shoot", &P::leaves_per_shoot, "", 1, 60,
             "Mean number of leaves in a cluster at a shoot's end."),
        real("shoot_length", &P::shoot_length, "m", 0.01, 2, "Mean length of a leaf-bearing shoot."),
        real("shoot_radius", &P::shoot_radius, "m", 0.0002, 0.05, "Radius of a leaf-bearing shoot."),
        real("shoot_angle", &P::shoot_angle, "degrees", 0, 120,
             "Mean angle between a shoot and the twig that bears it."),
        real("leaf_length", &P::leaf_length, "m", 0.005, 1, "Mean length of a leaf blade, or of a conifer's spray."),
        real("leaf_length_spread", &P::leaf_length_spread, "", 0, 0.6, "Leaf lengths vary by this share of the mean."),
        real("leaf_width", &P::leaf_width, "of the length", 0.05, 1.5,
             "Width of a leaf blade, or of a conifer's spray."),
        real("leaf_fold", &P::leaf_fold, "degrees", 0, 60, "How far each half is folded up along the midrib."),
        real("leaf_up", &P::leaf_up, "", 0, 5, "How strongly leaves turn their upper side to the sky."),
        choice("leaf_form", &P::leaf_form, {"outline", "alpha"},
               "Polygons with the leaf's outline, or rectangular cards with the outline, or a conifer's needles, in an "
               "alpha texture."),
        choice("leaf_detail", &P::leaf_detail, {"kite", "lobed", "fine"},
               "Triangles of an outline leaf: 2 (a kite), 8 to 14 (lobed) or 26 to 54 (lobes and teeth); of a "
               "needle 1, 2 or 3."),
        whole("textures", &P::textures, "", 0, 1, "1: leaves and bark carry colour textures, 0: plain colours."),
    };
    for (ParameterRow& row : rows)
        row.description.group = "shoots and leaves";
    return rows;
}

} // namespace kokage
