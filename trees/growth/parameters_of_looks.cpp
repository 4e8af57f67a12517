#include "trees/growth/parameter_table.h"

namespace kokage {

std::vector<ParameterRow> look_rows() {
    using P = GrowthParameters;
    std::vector<ParameterRow> rows = {
        choice("season", &P::season, {"spring", "summer", "autumn", "winter", "blossom"},
               "Colour of the leaves; in winter all but conifers stand bare, with the same wood. Blossom: a cherry's "
               "leaves are clusters of flowers, other trees stand in their spring leaf.",
               "Archetti et al. 2009, Trends in Ecology and Evolution 24:166: autumn colours"),
        real("bare_twigs", &P::bare_twigs, "", 0, 20,
             "Fine side twigs on every shoot, which show when the tree is bare and are drawn only then."),
        choice("leaf_shape", &P::leaf_shape, leaf_kind_names(),
               "Whose leaves: a blade with its outline, or of conifers a spray, a piece of twig with its needles, "
               "which counts as one leaf.",
               "Stace 2010, New Flora of the British Isles"),
        choice("leaf_color", &P::leaf_color, leaf_kind_names(),
               "Whose reflectance and transmittance the leaves have, through the seasons.",
               "Hovi et al. 2017, Silva Fennica 51(4) 7753; Lukes et al. 2013, Remote Sensing Letters 4:667"),
        choice("leaf_arrangement", &P::leaf_arrangement, {"spiral", "opposite", "whorled", "distichous"},
               "How leaves stand along a shoot: one by one in a 2/5 spiral, in crossed pairs, five around, or left and "
               "right.",
               "Bell 2008, Plant Form: phyllotaxis"),
        real("leaf_angle", &P::leaf_angle, "degrees", 0, 120,
             "Angle between a leaf and its shoot, midway; 21 more at the shoot's foot, 21 less at its end."),
        real("leaf_crowding", &P::leaf_crowding, "", 0, 1,
             "0: leaves stand evenly along their shoot, 1: most of them near its end."),
        real("leaf_hang", &P::leaf_hang, "", 0, 1, "How far leaves hang: 0 as they stand, 1 straight down."),
        real("leaf_bend", &P::leaf_bend, "degrees", 0, 180, "How much lower the tip points than the base."),
        real("petiole_length", &P::petiole_length, "of the blade's length", 0, 2,
             "Stalk of the leaf; drawn where it is longer than a tenth of the blade."),
        whole("needles", &P::needles, "", 4, 400, "Needles (of a cypress: finest twigs) in a conifer's spray."),
        choice("bark", &P::bark, bark_kind_names(), "Whose bark the wood has."),
    };
    for (ParameterRow& row : rows)
        row.description.group = "leaves and bark, by species and season";
    return rows;
}

} // namespace kokage
