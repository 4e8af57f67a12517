#pragma once
// What `kokage shade` can be told.
#include "foliage/method.h"
#include "reflection/picture.h"
#include "viewer/scene/surroundings.h"
#include "viewer/scene/tree_source.h"

#include <filesystem>

namespace kokage {

struct ShadeOptions {
    TreeSource tree;
    Surroundings surroundings;

    std::string method = "bundles";
    std::optional<double> error;
    std::optional<int> effort, maps, bands; ///< each refused where the method or the outputs have no use for it
    std::optional<std::string> gather;
    ShadingOptions shading; ///< the rest of the method's options; complete after complete_shade_options()

    std::string leaf_reflectance, leaf_transmittance, bark_albedo; ///< colours; empty = the material's own

    std::filesystem::path output, image, report;
    std::filesystem::path lods; ///< a folder; empty = none
    bool split_sides = false;
    std::string image_size = "1280x960";
    PictureOptions picture;     ///< complete after complete_shade_options()
    std::filesystem::path data; ///< folder that relative names of trees and environments are also looked for in
};

void add_shade_options(CLI::App& app, ShadeOptions& options);

/// Checks everything that can be checked before the work, fills what follows from other options. Throws InputError.
void complete_shade_options(ShadeOptions& options);

/// Replaces reflectance and transmittance where the user gave them. Throws InputError if they add up to more than 1.
void override_optics(const ShadeOptions& options, PatchScene& scene);

} // namespace kokage
