#include "viewer/scene/tree_source.h"
#include "common/services/error.h"
#include "common/services/named_file.h"
#include "trees/growth.h"
#include "trees/read_tree.h"
#include "viewer/scene/output_check.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <set>

namespace kokage {
namespace fs = std::filesystem;
namespace {

bool is_species_file(const std::string& name) {
    return lower_ending(name) == ".json";
}

/// What doesn't fit an int; set_parameter() judges the others.
CLI::Validator number_of_leaves() {
    return CLI::Validator(
        [](std::string& text) {
            int number = 0;
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
            if (error == std::errc() && end == text.data() + text.size())
                return std::string();
            if (error == std::errc::invalid_argument)
                return "'" + text + "' is not a number";
            for (const ParameterDescription& p : parameter_descriptions({}))
                if (p.name == "leaves")
                    return "'" + text + "' is out of range; it takes " + range_text(p);
            return "'" + text + "' is not a number";
        },
        "");
}

bool is_tree_file(const std::string& name) {
    const std::string ending = lower_ending(name);
    return ending == ".glb" || ending == ".gltf" || ending == ".obj";
}

bool is_image_file(const std::string& name) {
    constexpr const char* kEndings[] = {".hdr", ".exr", ".png", ".jpg", ".jpeg", ".tif", ".tiff", ".webp"};
    return std::find(std::begin(kEndings), std::end(kEndings), lower_ending(name)) != std::end(kEndings);
}

} // namespace

Species asked_species(const TreeSource& source) {
    Species species = is_species_file(source.name) ? read_species(source.name) : find_species(source.name);
    GrowthParameters& parameters = species.parameters;
    std::set<std::string, std::less<>> given;
    if (source.leaves) {
        set_parameter(parameters, "leaves", std::to_string(*source.leaves));
        given.insert("leaves");
    }
    for (const std::string& setting : source.settings) {
        const std::size_t equals = setting.find('=');
        if (equals == 0 || equals == std::string::npos)
            throw InputError("--set: '" + setting + "' is not NAME=VALUE");
        const std::string_view name = std::string_view(setting).substr(0, equals);
        try {
            set_parameter(parameters, name, std::string_view(setting).substr(equals + 1));
        } catch (const InputError& error) {
            throw InputError("--set: " + std::string(error.what()));
        }
        if (!given.emplace(name).second)
            throw InputError("--set: '" + std::string(name) + "' is given twice; leave one of them out");
    }
    check_parameters(parameters);
    return species;
}

bool TreeSource::is_species() const {
    if (is_species_file(name))
        return true;
    std::string lower = name;
    std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return std::any_of(all_species().begin(), all_species().end(), [&](const Species& s) { return s.name == lower; });
}

fs::path TreeSource::file() const {
    return is_species() && !is_species_file(name) ? fs::path() : fs::path(name);
}

std::string TreeSource::stem() const {
    return is_species() && !is_species_file(name) ? find_species(name).name : fs::path(name).stem().string();
}

void add_growing_options(CLI::App& app, TreeSource& source) {
    app.add_option("--leaves", source.leaves,
                   "Grown trees: number of leaves (otherwise the species' own: 30000 for an oak)")
        ->check(number_of_leaves())
        ->type_name("N")
        ->group("Tree");
    app.add_option("--set", source.settings,
                   "Grown trees: a parameter's value, for example seed=7 or season=autumn; 'kokage grow --describe "
                   "oak' lists them; may "
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
    app.add_option(
           "--up", source.up,
           "Files: the axis that is up, y as glTF has it or z as 3ds Max and other programs write into OBJ files")
        ->transform(CLI::IsMember({"y", "z"}, CLI::ignore_case).description(""))
        ->type_name("y|z")
        ->capture_default_str()
        ->group("Tree");
}

void check_tree_source(const TreeSource& source) {
    if (source.is_species()) {
        if (!source.foliage.empty() || source.leaf_size != 0 || source.scale != 1 || source.up != "y")
            throw InputError("--foliage, --leaf-size, --scale and --up are for files; '" + source.name + "' is grown");
        asked_species(source);
        return;
    }
    if (source.leaves || !source.settings.empty())
        throw InputError("--leaves and --set are for grown trees; '" + source.name + "' is a file");
    if (!(source.leaf_size >= 0) || !std::isfinite(source.leaf_size))
        throw InputError("--leaf-size: it must be a length in metres above 0");
    if (!(source.scale > 0) || !std::isfinite(source.scale))
        throw InputError("--scale: it must be above 0");
    std::error_code ignored;
    if (is_image_file(source.name))
        throw InputError("'" + source.name +
                         "' is an image; give a tree (a species, or a .glb, .gltf or .obj), and images of light by "
                         "--environment");
    if (fs::is_directory(source.name, ignored))
        throw InputError("'" + source.name + "' is a folder; give a tree's file (.glb, .gltf, .obj)");
    if (!fs::exists(source.name, ignored)) {
        if (is_tree_file(source.name))
            throw InputError("there is no file '" + source.name +
                             "'; give its whole path, or --data FOLDER (or KOKAGE_DATA) where it lies");
        std::string known;
        for (const Species& species : all_species())
            known += (known.empty() ? "" : ", ") + species.name;
        throw InputError("there is no file '" + source.name + "', nor a species of that name; species: " + known);
    }
}

Tree obtain_tree(const TreeSource& source, Progress& progress, bool normal_textures) {
    if (source.is_species())
        return grow(asked_species(source).parameters, progress);
    return read_tree(source.name,
                     {.foliage_materials = source.foliage,
                      .leaf_size = float(source.leaf_size),
                      .scale = source.scale,
                      .z_is_up = source.up == "z",
                      .normal_textures = normal_textures},
                     progress);
}

std::optional<std::string> no_foliage_warning(const Tree& tree, const std::string& how_to_name) {
    if (!tree.leaves.empty() || tree.branching_known)
        return std::nullopt;
    constexpr std::size_t kShown = 20;
    std::string names;
    for (std::size_t m = 0; m < std::min(tree.materials.size(), kShown); ++m) {
        const std::string& name = tree.materials[m].name;
        names += (names.empty() ? "" : ", ") + (name.empty() ? "one without a name" : "'" + shown_name(name) + "'");
    }
    if (tree.materials.size() > kShown)
        names += " and " + std::to_string(tree.materials.size() - kShown) + " more";
    return "no foliage was found: all is taken for bark; give " + how_to_name +
           ", a material, mesh or node of the file; its materials are " + (names.empty() ? "none" : names);
}

} // namespace kokage
