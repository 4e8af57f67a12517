#pragma once
// One picture of one scene by one method at one effort: a line of render.json.
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

namespace kokage {

struct PictureRecord {
    std::string scene;  ///< "close", "teapot", "five"
    std::string method; ///< "fast", "path-traced", "skip: WHAT"
    std::string effort; ///< "error 0.15, 16 samples", "64 samples", "on", "off"
    int width = 0, height = 0, samples = 0;
    std::optional<double> error; ///< asked of the leaves' light: fast
    double cpu_seconds = 0;      ///< of the whole picture: everything after loading and growing
    double transport_cpu_seconds = 0, solve_cpu_seconds = 0, render_cpu_seconds = 0; ///< bakes are of rendering
    /// Over the judged pixels that show tree, object or ground, and all channels: of |x - ref| over the mean of ref.
    std::optional<double> mean_error, p95_error;
    std::optional<double> bias;            ///< of x - ref over the mean of ref
    std::optional<double> reference_noise; ///< mean error of the reference itself, from its two independent halves
    std::map<std::string, double> mean_error_of, bias_of; ///< by what the pixel shows: leaf, bark, object, ground, edge
    std::map<std::string, double> share_of;               ///< of the judged pixels
    /// Root mean squares over the mean of ref: what stays with any number of samples, and what goes.
    std::map<std::string, double> systematic_error_of, sampling_error_of;
    /// The bias, by what the pixel shows and by which light is wrong: direct, indirect, reflected (PictureLayers).
    std::map<std::string, std::map<std::string, double>> bias_by_light;
    /// skips that are on: mean of |on - off| over the mean of off, of all pixels and channels.
    std::optional<double> change_by_skip;
    /// fast: CPU of path tracing to the same error over this one's.
    std::optional<double> times_less_cpu_than_path_tracing;
    std::string note;
};

/// Error judged by a truth whose noise is at most a fifth of it.
bool is_judged(const PictureRecord& record);

/// All fields, and "judged"; null where there is no figure.
nlohmann::json to_json(const PictureRecord& record);

} // namespace kokage
