#pragma once
// The report of a rendering as JSON (`kokage render --report`).
#include "viewer/scene/render_scene.h"

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

namespace kokage {

/// What a rendering was made from and what it took.
struct RenderRecord {
    std::vector<std::pair<std::string, std::string>> arguments; ///< options as the user gave them, in his order
    const SceneDescription* description = nullptr;
    const AssembledScene* scene = nullptr;
    RenderOptions options;
    WorkReport work;                                          ///< of everything
    WorkReport picture;                                       ///< parts of the stage that draws
    double exposure_stops = 0;                                ///< of .png pictures
    double subject_share = 0;                                 ///< of the picture's pixels that show surfaces
    double subject_radiance = 0;                              ///< their mean luminance
    std::vector<std::pair<std::string, std::string>> outputs; ///< what ("picture"), file
    double cpu_seconds = 0, wall_seconds = 0;                 ///< of everything
};

/// Numbers that are not finite become null.
nlohmann::ordered_json render_report(const RenderRecord& record);

const char* render_method_name(RenderMethod method);

} // namespace kokage
