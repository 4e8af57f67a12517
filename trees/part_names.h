#pragma once
// What the names of materials, meshes and nodes say: leaves, wood, or neither, in the languages that tree tools and
// their users name parts in (English, German, French, Spanish, Portuguese, Italian, Japanese in Latin letters). Private
// to trees.
#include "trees/tree.h"

#include <optional>
#include <string>

namespace kokage {

struct NameSense {
    bool foliage = false, wood = false;
    /// None if it says neither. Where it says both, the last word counts, as in "branch_leaves" and "leaf_stem".
    std::optional<TreePartKind> kind;
    bool is_mixed() const { return foliage && wood; }
};

/// Colours ("DarkGreen", "brown") count only where no other word tells; "leafless", "leaf litter" and "Laubbaum" do not
/// speak of this tree's leaves.
NameSense sense_of_name(const std::string& name);

/// True if a name speaks of leaves and of wood no later ("leaves", "Needles_02", "DarkGreen", "Herbstlaub").
bool names_foliage(const std::string& name);
/// True if a name speaks of wood ("bark", "Trunk", "woodBirch", "Rinde"), whatever else it says.
bool names_wood(const std::string& name);
/// True if it speaks of a whole tree ("tree", "Baum"): beside a part that is called leaves, that is the wood.
bool names_tree(const std::string& name);
/// True if it speaks of what stands with a plant and is no part of it ("pot", "soil", "rocks").
bool names_object(const std::string& name);

/// Lower case, German and French capitals too.
std::string lower_case(const std::string& text);

} // namespace kokage
