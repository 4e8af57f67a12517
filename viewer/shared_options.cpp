#include "viewer/shared_options.h"
#include "common/services/error.h"
#include "common/services/named_file.h"

#include <algorithm>
#include <cmath>

namespace kokage {

CLI::Option* add_exposure_option(CLI::App& app, std::optional<float>& stops, const std::string& otherwise,
                                 const std::string& linear) {
    return app
        .add_option("--exposure", stops, "Its exposure in stops (otherwise " + otherwise + "); not for " + linear)
        ->type_name("STOPS");
}

void check_exposure(const std::optional<float>& stops, const std::vector<std::filesystem::path>& pictures) {
    if (!stops)
        return;
    if (!(std::abs(*stops) <= 100))
        throw InputError("--exposure: it must be from -100 to 100 stops");
    const auto is_linear = [](const std::filesystem::path& picture) {
        return lower_ending(picture) == ".exr" || lower_ending(picture) == ".hdr";
    };
    if (!pictures.empty() && std::all_of(pictures.begin(), pictures.end(), is_linear))
        throw InputError("--exposure: " + lower_ending(pictures.front()) +
                         " pictures hold the light as it is; leave it out, or write a .png");
}

CLI::Option* add_report_option(CLI::App& app, std::filesystem::path& report) {
    return app.add_option("--report", report, "What was done, counted, timed and skipped")->type_name("R.json");
}

CLI::Option* add_error_option(CLI::App& app, std::optional<double>& error, const std::string& text) {
    return app.add_option("--error", error, text)->type_name("E");
}

void check_error(const std::optional<double>& error) {
    if (error && !(*error > 0 && *error <= 10))
        throw InputError("--error: it must be above 0 (0.05 is 5 %) and at most 10");
}

} // namespace kokage
