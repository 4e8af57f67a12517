#pragma once
// One method on one map and view: a line of relief.json.
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

namespace kokage {

struct ReliefRecord {
    std::string experiment; ///< "views", "paper", "shadows", "occlusion", "preparation"
    std::string map;        ///< "bark", "spikes", "low", a file's name
    int size = 0;           ///< texels along an edge
    std::string view;       ///< "plane-10" (degrees from the normal) ... "plane-85", "sphere"; "" where there is none
    std::string method;     ///< "exact", "linear-128", "depth-maps-64", ...
    std::uint64_t rays = 0;
    std::optional<std::uint64_t> wrong; ///< more than half a texel from the true first hit, ties not counted
    std::optional<std::uint64_t> ties;  ///< as far away, but one of both hits grazes the surface within 1e-6 of depth
    std::optional<double> reads_mean, reads_p99; ///< a ray
    std::optional<double> ns_per_ray;            ///< CPU of one thread
    std::optional<double> preprocess_cpu_seconds;
    std::optional<double> bytes;     ///< depths and precomputed data
    std::optional<double> rms_error; ///< ambient occlusion
    std::string note;
};

/// All fields; null where there is no figure.
nlohmann::json to_json(const ReliefRecord& record);

} // namespace kokage
