#include "trees/growth/parameters.h"

#include "common/services/error.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <numeric>
#include <sstream>

namespace kokage {
namespace {

using P = GrowthParameters;

struct Entry {
    std::string name, unit;
    double low, high;
    bool whole;
    std::function<double(const P&)> get;
    std::function<void(P&, double)> set;
    std::string meaning;
    std::vector<std::string> choices = {};
};

Entry real(const char* name, double P::*member, const char* unit, double low, double high, const char* meaning) {
    return {name,
            unit,
            low,
            high,
            false,
            [member](const P& p) { return p.*member; },
            [member](P& p, double v) { p.*member = v; },
            meaning};
}
Entry whole(const char* name, int P::*member, const char* unit, double low, double high, const char* meaning) {
    return {name,
            unit,
            low,
            high,
            true,
            [member](const P& p) { return double(p.*member); },
            [member](P& p, double v) { p.*member = int(v); },
            meaning};
}

const std::vector<Entry>& entries() {
    static const std::vector<Entry> table = {
        {"seed", "", 0, 9007199254740992.0, true, [](const P& p) { return double(p.seed); },
         [](P& p, double v) { p.seed = std::uint64_t(v); }, "Which individual: the same seed gives the same tree."},
        whole("leaves", &P::leaves, "", 1, 2000000, "Number of leaves; the tree's size follows from it."),
        real("leaf_length", &P::leaf_length, "m", 0.005, 1, "Mean length of a leaf blade."),
        real("leaf_length_spread", &P::leaf_length_spread, "", 0, 0.6, "Leaf lengths vary by this share of the mean."),
        real("leaf_width", &P::leaf_width, "of the length", 0.05, 1.5, "Width of a leaf blade."),
        real("leaf_fold", &P::leaf_fold, "degrees", 0, 60, "How far each half is folded up along the midrib."),
        real("leaf_up", &P::leaf_up, "", 0, 5, "How strongly leaves turn their upper side to the sky."),
        {"leaf_form",
         "",
         0,
         1,
         true,
         [](const P& p) { return double(int(p.leaf_form)); },
         [](P& p, double v) { p.leaf_form = LeafForm(int(v)); },
         "Polygons with the leaf's outline, or rectangular cards with the outline in an alpha texture.",
         {"outline", "alpha"}},
        {"leaf_detail",
         "",
         0,
         2,
         true,
         [](const P& p) { return double(p.leaf_detail); },
         [](P& p, double v) { p.leaf_detail = int(v); },
         "Triangles of an outline leaf: 2 (a kite), 8 (lobed) or 44 (round lobes).",
         {"kite", "lobed", "fine"}},
        real("leaves_per_shoot", &P::leaves_per_shoot, "", 1, 60,
             "Mean number of leaves in a cluster at a shoot's end."),
        real("shoot_length", &P::shoot_length, "m", 0.01, 2, "Mean length of a leaf-bearing shoot."),
        real("shoot_radius", &P::shoot_radius, "m", 0.0002, 0.05, "Radius of a leaf-bearing shoot."),
        real("shoot_angle", &P::shoot_angle, "degrees", 0, 120,
             "Mean angle between a shoot and the twig that bears it."),
        real("leaf_area_index", &P::leaf_area_index, "m2 per m2", 0.2, 20,
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
        real("crown_shell", &P::crown_shell, "", 0, 12, "How much foliage keeps to the outside of the crown; 0: even."),
        real("crown_clumping", &P::crown_clumping, "", 0, 1, "Share of the foliage that gathers in clumps."),
        real("trunk_reach", &P::trunk_reach, "of the height", 0.05, 0.98, "How high the trunk can be followed."),
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
             "How far a limb keeps its course towards the crown's surface."),
        real("branch_zigzag", &P::branch_zigzag, "degrees", 0, 60, "How much finer branches wander."),
        real("branch_up", &P::branch_up, "", -1, 1, "How strongly finer branches turn upwards."),
        real("pipe_exponent", &P::pipe_exponent, "", 1.2, 4,
             "Pipe model: radius^e of a branch is the sum over its children; 2 keeps cross-sections."),
        real("root_flare", &P::root_flare, "of the radius", 0, 3, "How much the trunk widens at the ground."),
        real("bark_tile", &P::bark_tile, "m", 0.02, 10, "Size of one tile of bark texture on the trunk."),
        whole("textures", &P::textures, "", 0, 1, "1: leaves and bark carry colour textures, 0: plain colours."),
    };
    return table;
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t(0));
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t above = row[j];
            row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0u : 1u)});
            diagonal = above;
        }
    }
    return row[b.size()];
}

std::string range_text(const Entry& entry) {
    std::ostringstream text;
    text.precision(12);
    if (entry.choices.empty()) {
        text << entry.low << " to " << entry.high << (entry.unit.empty() ? "" : " ") << entry.unit;
    } else {
        for (std::size_t i = 0; i < entry.choices.size(); ++i)
            text << (i == 0 ? "" : i + 1 == entry.choices.size() ? " or " : ", ") << entry.choices[i];
    }
    return text.str();
}

void check(const Entry& entry, double value) {
    const bool ok = std::isfinite(value) && value >= entry.low && value <= entry.high &&
                    (!entry.whole || value == std::floor(value));
    if (ok)
        return;
    std::ostringstream text;
    text.precision(12);
    text << entry.name << " = " << value << " is out of range; it takes "
         << (entry.whole && entry.choices.empty() ? "a whole number, " : "") << range_text(entry);
    throw InputError(text.str());
}

} // namespace

std::vector<ParameterDescription> parameter_descriptions(const GrowthParameters& parameters) {
    std::vector<ParameterDescription> result;
    for (const Entry& e : entries())
        result.push_back({e.name, e.unit, e.low, e.high, e.whole, e.get(parameters), e.meaning, e.choices});
    return result;
}

void set_parameter(GrowthParameters& parameters, std::string_view name, std::string_view value) {
    const auto& table = entries();
    const auto found = std::find_if(table.begin(), table.end(), [&](const Entry& e) { return e.name == name; });
    if (found == table.end()) {
        const auto nearest = std::min_element(table.begin(), table.end(), [&](const Entry& a, const Entry& b) {
            return edit_distance(a.name, name) < edit_distance(b.name, name);
        });
        throw InputError("no growth parameter is called '" + std::string(name) + "'; did you mean '" + nearest->name +
                         "'? All are listed by 'kokage grow --describe " + parameters.species + "'");
    }
    const auto choice = std::find(found->choices.begin(), found->choices.end(), value);
    double number = double(choice - found->choices.begin());
    if (choice == found->choices.end()) {
        const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
        if (error != std::errc() || end != value.data() + value.size())
            throw InputError(found->name + " = '" + std::string(value) + "' can't be read; it takes " +
                             range_text(*found));
    }
    check(*found, number);
    found->set(parameters, number);
}

void check_parameters(const GrowthParameters& parameters) {
    for (const Entry& entry : entries())
        check(entry, entry.get(parameters));
}

} // namespace kokage
