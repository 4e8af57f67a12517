#pragma once
// What a tree grows from: a species is a set of these values.
#include "trees/growth/bark_kind.h"
#include "trees/growth/leaf_outline.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace kokage {

enum class LeafForm {
    outline, ///< a flat polygon with the leaf's outline
    alpha    ///< a rectangular card with the outline in its alpha texture
};

/// How leaves stand along a shoot (phyllotaxis).
enum class LeafArrangement {
    spiral,    ///< one by one, 144 degrees on from the last (2/5)
    opposite,  ///< in pairs, each pair at right angles to the last
    whorled,   ///< five around the shoot, each whorl turned by half a step
    distichous ///< one by one, left and right, in a level plane
};

/// What the leaves look like, and whether there are any.
enum class Season { spring, summer, autumn, winter, blossom };

/// Of one tree; scene files take no more either.
inline constexpr int kMostLeaves = 2000000;

/// Lengths in metres, angles in degrees. Ranges, units and meanings: parameter_descriptions().
struct GrowthParameters {
    std::string species = "oak";
    std::uint64_t seed = 1;
    int leaves = 30000;
    int young_below = 3000;

    // The crown, trunk, limbs, branches and bark: rows in parameters_of_wood.cpp.
    double leaf_area_index = 4.5, height_to_width = 0.84;
    double crown_base = 0.22, crown_widest = 0.36, crown_bottom = 0.76, crown_roundness = 2.0, crown_underside = 2.0;
    int crown_lobes = 20;
    double crown_lobe_depth = 0.2, crown_shell = 2.5, crown_clumping = 0.2;
    double crown_layers = 0, layer_width = 0.3, layer_depth = 0.05;

    double trunk_reach = 0.62, trunk_wiggle = 9;
    int limbs = 9, limb_whorl = 1;
    double limb_divergence = 137.5, limb_first = 0.17, limb_last = 0.52;
    double limb_elevation_low = 14, limb_elevation_high = 62, limb_bend = 0, limb_zigzag = 26, limb_reach = 0.75,
           limb_bare = 0.22;

    double branch_angle = 50, branch_angle_spread = 20, apical_dominance = 0.1;
    double branch_up = 0.1, branch_to_light = 0, branch_zigzag = 16, twig_sag = 0;
    double light_need = 0, stand = 0, pipe_exponent = 2.0;
    double shoot_up = 0.12, shoot_hang = 0;

    double root_flare = 0.9, bark_tile = 0.4;

    // Shoots, leaves and looks: rows in parameters_of_leaves.cpp.
    double leaves_per_shoot = 7, shoot_length = 0.13, shoot_radius = 0.0024, shoot_angle = 48;
    double leaf_length = 0.10, leaf_length_spread = 0.2, leaf_width = 0.62, leaf_fold = 12, leaf_up = 1.4;
    LeafForm leaf_form = LeafForm::outline;
    int leaf_detail = 1;
    int textures = 1;

    // What leaves and bark are like, and when: rows in parameters_of_looks.cpp.
    LeafKind leaf_shape = LeafKind::oak, leaf_color = LeafKind::oak;
    LeafArrangement leaf_arrangement = LeafArrangement::spiral;
    double leaf_angle = 59, leaf_crowding = 1, leaf_hang = 0, leaf_bend = 0, petiole_length = 0;
    int needles = 60;
    BarkKind bark = BarkKind::oak;
    Season season = Season::summer;
    double bare_twigs = 3;
};

struct ParameterDescription {
    std::string name = {}, group = {}, unit = {}; ///< unit "m", "degrees", "of the height", ...; empty = a pure number
    double low = 0, high = 0;
    bool whole = false; ///< takes whole numbers only
    double value = 0;   ///< in the parameters that were asked about
    std::string meaning = {};
    std::string source = {};               ///< where the botany or physics comes from; empty = our own measure
    std::vector<std::string> choices = {}; ///< names of the values low..high, if they have names
};

/// All parameters that set_parameter knows, in reading order, with their values in `parameters`.
std::vector<ParameterDescription> parameter_descriptions(const GrowthParameters& parameters);

/// Sets a parameter by name from text. Throws InputError: unknown name (with the nearest known one), not a number, out
/// of range.
void set_parameter(GrowthParameters& parameters, std::string_view name, std::string_view value);

/// The same from a number. Throws InputError also where the parameter takes a name.
void set_parameter(GrowthParameters& parameters, std::string_view name, double value);

/// Throws InputError if a value is not finite or out of its range.
void check_parameters(const GrowthParameters& parameters);

/// A description's value as text, as set_parameter reads it: "0.1", "outline".
std::string value_text(const ParameterDescription& description);
/// What it takes, for people: "0.005 to 1 m", "outline or alpha".
std::string range_text(const ParameterDescription& description);

} // namespace kokage
