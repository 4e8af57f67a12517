#pragma once
// The report of a bake as JSON (`kokage bake --report`).
#include "reflection/maps/bake_sequence.h"
#include "viewer/bake_options.h"

#include <nlohmann/json_fwd.hpp>

namespace kokage {

/// What a map was made from and what it took.
struct BakeRecord {
    const BakeOptions* options = nullptr;
    const Environment* environment = nullptr; ///< of a single map
    EnvironmentReport environment_report;
    const SequenceResult* sequence = nullptr; ///< of a video
    WorkReport work;
    double cpu_seconds = 0, wall_seconds = 0;
};

/// Numbers that are not finite become null.
nlohmann::ordered_json bake_report(const BakeRecord& record);

/// What a frame's map depends on beside its image: another one makes other maps.
nlohmann::ordered_json bake_identity(const BakeOptions& options);

} // namespace kokage
