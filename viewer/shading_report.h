#pragma once
// The report of a shading as JSON (`--report`).
#include "common/environment/environment.h"
#include "foliage/method.h"
#include "trees/tree.h"

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

namespace kokage {

/// What a shading was made from and what it took.
struct ShadingRecord {
    std::vector<std::pair<std::string, std::string>> arguments; ///< options as the user gave them, in his order
    const Tree* tree = nullptr;
    const PatchScene* patches = nullptr;
    const Environment* environment = nullptr;
    EnvironmentReport environment_report;
    ShadingOptions options;
    const Solution* solution = nullptr;
    WorkReport work; ///< the program's own stages: growing or loading, transport, solving, picture, writing
    std::vector<std::pair<std::string, std::string>> outputs; ///< what ("picture"), file
    double cpu_seconds = 0, wall_seconds = 0;                 ///< of everything
};

/// Numbers that are not finite become null.
nlohmann::ordered_json shading_report(const ShadingRecord& record);

} // namespace kokage
