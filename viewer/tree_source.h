#pragma once
// The tree that a command works on: a species to grow or a file to load.
#include "common/services/progress.h"
#include "trees/tree.h"

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

namespace kokage {

struct TreeSource {
    std::string name = "oak"; ///< a species or a file
    std::optional<int> leaves;
    std::vector<std::string> settings; ///< NAME=VALUE
    std::vector<std::string> foliage;  ///< files: names of foliage materials; empty = found out
    double leaf_size = 0;              ///< files: metres; 0 = found out
    double scale = 1;                  ///< files: metres per unit

    /// True if `name` is a species rather than a file: a species' name always is.
    bool is_species() const;
    /// What files made from it are called: "oak", or the file's stem.
    std::string stem() const;
};

/// Options of growing: --leaves, --set.
void add_growing_options(CLI::App& app, TreeSource& source);
/// Options of loading: --foliage, --leaf-size, --scale.
void add_loading_options(CLI::App& app, TreeSource& source);

/// Throws InputError, before any work, if a value can't be: an unknown species that is no file either, a parameter out
/// of range, options of growing for a file or of loading for a species.
void check_tree_source(const TreeSource& source);

/// Grows or loads it. Throws InputError, Stopped.
Tree obtain_tree(const TreeSource& source, Progress& progress);

} // namespace kokage
