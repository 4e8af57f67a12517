#pragma once
// Options that several commands take, and what is refused of them.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>

namespace kokage {

/// --samples; Count: int, or std::optional<int> where something else may tell it, which `otherwise` names.
template <typename Count>
CLI::Option* add_samples_option(CLI::App& app, Count& samples, const std::string& otherwise = "") {
    return app.add_option("--samples", samples, "Its camera rays a pixel" + otherwise)
        ->type_name("N")
        ->check(CLI::Range(1, 65536).description(""));
}

/// --exposure; `otherwise`: what holds where it is not given; `linear`: the endings that it is not for.
CLI::Option* add_exposure_option(CLI::App& app, std::optional<float>& stops, const std::string& otherwise,
                                 const std::string& linear);
/// Throws InputError for stops out of range, and if every picture (there is one) holds light as it is.
void check_exposure(const std::optional<float>& stops, const std::vector<std::filesystem::path>& pictures);

/// --report.
CLI::Option* add_report_option(CLI::App& app, std::filesystem::path& report);

/// --error; `text`: whose it is, and what it is otherwise.
CLI::Option* add_error_option(CLI::App& app, std::optional<double>& error, const std::string& text);
/// Throws InputError for errors out of range.
void check_error(const std::optional<double>& error);

} // namespace kokage
