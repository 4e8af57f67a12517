#pragma once
// One measurement of one way to make or to use a reflection map: a line of reflection.json.
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

namespace kokage {

struct ReflectionRecord {
    std::string experiment;  ///< "table-2", "spectral", "hdr", "shells", "teapot", "cmgen", "video", "skips", ...
    std::string environment; ///< "pattern", "photograph", a file's name, "sun-1e6", ...
    std::string method;      ///< "spectral", "table", "table-paper", "brute-force", or a peer's name
    std::string lobe;        ///< "phong", "ggx"; empty where it is not about one
    int size = 0;            ///< cube: voxels along an edge; cube map: texels along a face's edge; shells: see note
    std::optional<double> threshold;         ///< of the table's weights
    std::optional<double> smoothness;        ///< lambda, or roughness for GGX: where one record is about one value
    std::optional<double> setup_cpu_seconds; ///< what is done once for a layout and a size of image
    std::optional<double> cpu_seconds;       ///< user + system, all threads, of one bake or one picture, after set-up
    std::optional<double> wall_seconds;      ///< of the same
    std::optional<double> frames_per_second; ///< video
    std::optional<double> texels;            ///< that were filtered
    std::optional<double> bytes;             ///< of what is kept: the map, or the table where that is what is measured
    std::optional<double> mean_error_255;    ///< mean over texels or pixels and channels of |x - ref|, 255 for 1
    std::optional<double> max_error_255;
    std::optional<double> mean_relative_error; ///< of |x - ref| / max(ref, 1e-3 of the reference's mean)
    std::optional<double> max_relative_error;
    std::optional<double> mean_error_of_mean; ///< mean of |x - ref| over the surroundings' mean radiance
    std::string note; ///< what the numbers can't say: pixel format, number of samples judged, what was left out
};

/// All fields; null where there is no figure, or where it is not finite.
nlohmann::json to_json(const ReflectionRecord& record);

} // namespace kokage
