#include "viewer/tree_source.h"
#include "common/services/error.h"
#include "trees/growth.h"
#include "trees/read_tree.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

namespace kokage {
namespace fs = std::filesystem;
namespace {

GrowthParameters growth_parameters(const TreeSource& source) {
    GrowthParameters parameters = find_species(source.name).parameters;
    if (source.leaves)
        set_parameter(parameters, "leaves", std::to_string(*source.leaves));
    for (const std::string& setting : source.settings) {
        const std::size_t equals = setting.find('=');
        if (equals == 0 || equals == std::string::npos)
            throw InputError("--set: '" + setting + "' is not NAME=VALUE");
        set_parameter(parameters, setting.substr(0, equals), setting.substr(equals + 1));
    }
    check_parameters(parameters);
    return parameters;
}

} // namespace

bool TreeSource::is_species() const {
    std::string lower = name;
    std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return std::any_of(all_species().begin(), all_species().end(), [&](const Species& s) { return s.name == lower; });
}

std::string TreeSource::stem() const {
    return is_species() ? find_species(name).name : fs::path(name).stem().string();
}

void add_growing_options(CLI::App& app, TreeSource& source) {
    app.add_option("--leaves", source.leaves, "Grown trees: number of leaves (oak: 30000)")
        ->type_name("N")
        ->group("Tree");
    app.add_option("--set", source.settings,
                   "Grown trees: a parameter's value, for example seed=7; 'kokage grow --describe oak' lists them; may "
                   "be repeated")
        ->type_name("NAME=VALUE")
        ->allow_extra_args(false)
        ->group("Tree");
}

void add_loading_options(CLI::App& app, TreeSource& source) {
    app.add_option("--foliage", source.foliage,
                   "Files: name of a material, mesh or node that is foliage, when it is found wrongly; may be repeated")
        ->type_name("NAME")
        ->allow_extra_args(false)
        ->group("Tree");
    app.add_option("--leaf-size", source.leaf_size,
                   "Files: radius in metres of the patches that large connected foliage is cut into (otherwise 5 % of "
                   "the crown's)")
        ->type_name("M")
        ->group("Tree");
    app.add_option("--scale", source.scale, "Files: metres in one unit of the file (0.01 for centimetres)")
        ->type_name("X")
        ->group("Tree");
}

void check_tree_source(const TreeSource& source) {
    if (source.is_species()) {
        if (!source.foliage.empty() || source.leaf_size != 0 || source.scale != 1)
            throw InputError("--foliage, --leaf-size and --scale are for files; '" + source.name + "' is grown");
        growth_parameters(source);
        return;
    }
    if (source.leaves || !source.settings.empty())
        throw InputError("--leaves and --set are for grown trees; '" + source.name + "' is a file");
    if (!(source.leaf_size >= 0) || !std::isfinite(source.leaf_size))
        throw InputError("--leaf-size: it must be a length in metres above 0");
    if (!(source.scale > 0) || !std::isfinite(source.scale))
        throw InputError("--scale: it must be above 0");
    std::error_code ignored;
    if (fs::is_directory(source.name, ignored))
        throw InputError("'" + source.name + "' is a folder; give a tree's file (.glb, .gltf)");
    if (!fs::exists(source.name, ignored)) {
        std::string known;
        for (const Species& species : all_species())
            known += (known.empty() ? "" : ", ") + species.name;
        throw InputError("there is no file '" + source.name + "', nor a species of that name; species: " + known);
    }
}

Tree obtain_tree(const TreeSource& source, Progress& progress) {
    if (source.is_species())
        return grow(growth_parameters(source), progress);
    return read_tree(source.name,
                     {.foliage_materials = source.foliage, .leaf_size = float(source.leaf_size), .scale = source.scale},
                     progress);
}

} // namespace kokage
