#pragma once
// The tree that a command works on: a species to grow (one that is known, or a species file) or a tree's file to load.
#include "common/services/progress.h"
#include "trees/species.h"
#include "trees/tree.h"
#include "viewer/scene/cli_forward.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace kokage {

struct TreeSource {
    std::string name = "oak"; ///< a species, a species file (.json) or a tree's file
    std::optional<int> leaves;
    std::vector<std::string> settings; ///< NAME=VALUE
    std::vector<std::string> foliage;  ///< files: names of foliage materials; empty = found out
    double leaf_size = 0;              ///< files: metres; 0 = found out
    double scale = 1;                  ///< files: metres per unit
    std::string up = "y";              ///< files: "y" or "z", the axis that is up

    /// True if `name` is to be grown rather than loaded: a species' name always is, and so is a species file.
    bool is_species() const;
    /// The file that it is read from; empty if there is none.
    std::filesystem::path file() const;
    /// What files made from it are called: "oak", or the file's stem.
    std::string stem() const;
};

/// Options of growing: --leaves, --set.
void add_growing_options(CLI::App& app, TreeSource& source);
/// Options of loading: --foliage, --leaf-size, --scale, --up.
void add_loading_options(CLI::App& app, TreeSource& source);

/// Throws InputError, before any work, if a value can't be: an unknown species that is no file either, a parameter out
/// of range, options of growing for a file or of loading for a species.
void check_tree_source(const TreeSource& source);

/// The species to grow, with --leaves and --set in its parameters. Throws InputError.
Species asked_species(const TreeSource& source);

/// Grows or loads it; `normal_textures`: ReadOptions'. Throws InputError, Stopped.
Tree obtain_tree(const TreeSource& source, Progress& progress, bool normal_textures = false);

/// For a stranger's file in which nothing was taken for leaves; nothing to say of bare trees that know themselves bare.
/// `how_to_name`: by what the user says which material is foliage.
std::optional<std::string> no_foliage_warning(const Tree& tree, const std::string& how_to_name);

} // namespace kokage
