#pragma once
// Programs of others that come as npm packages and run under Node.js or in a browser: see tests/validate.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace kokage {

/// The folder of npm packages that has `package`: KOKAGE_NODE_MODULES, or tests/validate/node_modules; empty if there
/// is none, or no Node.js.
inline std::string node_modules_with(const std::string& package) {
    const char* named = std::getenv("KOKAGE_NODE_MODULES");
    const std::filesystem::path folder = named && *named
                                             ? std::filesystem::path(named)
                                             : std::filesystem::path(KOKAGE_TESTS_FOLDER) / "validate" / "node_modules";
    const bool there = std::filesystem::exists(folder / package) && std::system("node --version >/dev/null 2>&1") == 0;
    return there ? folder.string() : "";
}

/// Whether pages can be run in a browser (tests/validate/in_browser.js).
inline bool browser_is_there() {
    return std::system(("node -e \"process.exit(require('" + std::string(KOKAGE_TESTS_FOLDER) +
                        "/validate/in_browser.js').findChromium() ? 0 : 1)\"")
                           .c_str()) == 0;
}

/// Runs a script of tests/validate with arguments, `input` (a file; empty = none) as its standard input, and reads the
/// JSON that it prints. The test fails if the script does.
inline nlohmann::json run_node(const std::string& script, const std::vector<std::string>& arguments,
                               const std::filesystem::path& input = {}) {
    std::string command = std::string("node '") + KOKAGE_TESTS_FOLDER + "/validate/" + script + "'";
    for (const std::string& argument : arguments)
        command += " '" + argument + "'";
    command += " < '" + (input.empty() ? std::string("/dev/null") : input.string()) + "'";
    FILE* pipe = popen(command.c_str(), "r");
    std::string output;
    char block[4096];
    while (const std::size_t count = std::fread(block, 1, sizeof block, pipe))
        output.append(block, count);
    EXPECT_EQ(pclose(pipe), 0) << command;
    return nlohmann::json::parse(output, nullptr, false);
}

} // namespace kokage
