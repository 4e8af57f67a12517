#pragma once
// What `kokage bake` can be told.
#include "reflection/maps/baked_map.h"
#include "viewer/scene/cli_forward.h"
#include "viewer/scene/surroundings.h"

#include <filesystem>
#include <optional>
#include <string>

namespace kokage {

struct BakeOptions {
    Surroundings surroundings; ///< .environment is ENV
    std::filesystem::path data;

    std::string container, lobe, smoothness, roughness, filter = "bilinear", format = "half",
                                                        roughness_scale = "solved";
    std::string compression;
    std::optional<int> size, levels;
    std::optional<double> detail;

    std::optional<int> bands;
    std::string quantity = "radiance";
    bool list_lights = false;

    std::string method = "spectral", weights = "matched";
    std::optional<double> tolerance, threshold;
    std::filesystem::path stored;

    std::string output;
    std::filesystem::path report;
    std::string broken_frames = "skip";

    bool is_sequence = false; ///< by complete_bake_options
    MapSettings map{};
    MapPlan plan{}; ///< of `map`
    BakerSettings baker{};
};

void add_bake_options(CLI::App& app, BakeOptions& options);

/// Checks everything that can be known before any work, the memory that it takes too, and fills `map`, `plan` and
/// `baker`. Throws InputError.
void complete_bake_options(BakeOptions& options);

} // namespace kokage
