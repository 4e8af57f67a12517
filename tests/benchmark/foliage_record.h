#pragma once
// One measurement of one method on one scene: a line of foliage.json.
#include "foliage/accuracy.h"
#include "foliage/method.h"

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace kokage {

struct FoliageRecord {
    std::string scene; ///< the light: "sky-sun", "lamp-lit", ...
    std::uint32_t leaves = 0;
    std::string material; ///< "realistic", "bright", "white"
    Method method = Method::bundles;
    std::string effort_kind; ///< what `effort` counts: "directions", "paths", "maps", or "asked error"
    double effort = 0;
    double cpu_seconds = 0; ///< make_transport and the first solve, all threads; the median where it was repeated
    double wall_seconds = 0;
    std::optional<double>
        relight_cpu_seconds;   ///< a second solve: another environment, the same lights; empty if not measured
    double bytes_per_leaf = 0; ///< kept between relights
    Accuracy accuracy;
    std::optional<double> estimated_error; ///< by the method itself, of the MRE
    double reference_noise = 0;            ///< of the reference, as an MRE; 0 where the truth is known exactly
    std::optional<double> relight_mre;     ///< of the relit solution, where the relit scene has a reference
    std::optional<double> paths;           ///< traced in the first solve, if the method traces paths
    double maximum_error = 0;              ///< largest |x - ref| / max(ref, 0.05 mean)

    /// True if the error is at least five times the reference's noise; otherwise it says little.
    bool judged() const { return accuracy.mre >= 5 * reference_noise; }
};

/// The fields of issue and table, null where a method can't say.
nlohmann::json to_json(const FoliageRecord& record);

} // namespace kokage
