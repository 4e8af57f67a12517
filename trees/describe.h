#pragma once
// What was found in a tree, for people (text) and programs (JSON).
#include "trees/patches.h"
#include "trees/tree.h"

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace kokage {

struct TreeDescription {
    struct Order {
        std::size_t branches = 0;
        std::size_t bearing = 0; ///< branches that bear leaves themselves
        std::size_t leaves = 0;
        double mean_length_m = 0; ///< of the branches, along their axes
        double mean_radius_m = 0; ///< of their wood where it is thickest; 0 for imagined twigs
    };
    struct Surface {
        std::string material;
        TreePartKind kind = TreePartKind::bark;
        std::size_t triangles = 0;
        bool textured = false, masked = false;
        Optics optics;
        bool transmittance_guessed = false; ///< the file says nothing: 0.8 of the reflectance
    };
    std::string name, source;
    glm::dvec3 low{0.0}, high{0.0}; ///< of the whole tree, in the file's frame (metres)
    double crown_radius_m = 0;      ///< half the larger horizontal extent of the foliage
    std::size_t leaves = 0, bark_patches = 0, triangles = 0;
    double leaf_area_m2 = 0, bark_area_m2 = 0; ///< one side, holes of alpha masks taken out
    double crown_projection_m2 = 0; ///< ground under the leaves: their reach in 32 sectors around their middle
    double smallest_leaf_m2 = 0, median_leaf_m2 = 0, largest_leaf_m2 = 0;
    bool branching_known = true;
    bool was_shaded = false; ///< as Tree::was_shaded
    std::map<int, Order> orders;
    std::size_t leaves_without_branch = 0;
    std::vector<Surface> surfaces; ///< one for each part
    std::vector<std::string> notes;
};

/// Throws InputError if the tree's indices contradict one another.
TreeDescription describe(const Tree& tree);

/// Lines of a label and what belongs to it.
std::string text_of(const TreeDescription& description);
nlohmann::json json_of(const TreeDescription& description);

} // namespace kokage
