#include "common/services/error.h"
#include "common/services/memory.h"
#include "common/services/parallel.h"
#include "viewer/command.h"
#include "viewer/stop_signal.h"
#include "viewer/terminal_progress.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <new>
#include <optional>
#include <sstream>
#include <stdexcept>

namespace kokage {
namespace {

constexpr int kInternalError = 1, kInputError = 2, kStopped = 130;
constexpr const char* kNotEnoughMemory =
    "there is not enough memory for that; ask for less (a smaller size, fewer leaves, a smaller image), or close other "
    "programs";

/// Help whose descriptions are broken into lines, each under the first.
class WrappedFormatter : public CLI::Formatter {
  public:
    WrappedFormatter() { column_width(kNameColumns); }
    std::string make_option_desc(const CLI::Option* option) const override {
        return wrapped(CLI::Formatter::make_option_desc(option));
    }

  private:
    static constexpr std::size_t kNameColumns = 30, kTextColumns = 80;
    static std::string wrapped(const std::string& text) {
        std::istringstream words(text);
        std::string result, word;
        for (std::size_t column = 0; words >> word; column += word.size() + 1) {
            if (column > 0 && column + word.size() > kTextColumns) {
                result += '\n';
                column = 0;
            } else if (column > 0) {
                result += ' ';
            }
            result += word;
        }
        return result;
    }
};

int complain(std::string message, int status) {
    // One line, whatever a library put into its message.
    std::replace(message.begin(), message.end(), '\n', ' ');
    std::fprintf(stderr, "kokage: %s\n", message.c_str());
    return status;
}

/// The first word of a command line that names no command.
std::optional<std::string> unknown_command(const CLI::App& program) {
    if (!program.get_subcommands().empty())
        return {};
    for (const std::string& word : program.remaining())
        if (word.rfind('-', 0) != 0)
            return word;
    return {};
}

std::string no_such_command(const std::string& name, const std::vector<Command>& commands) {
    std::string known;
    for (const Command& command : commands)
        known += (known.empty() ? "" : ", ") + command.app->get_name();
    return "there is no command '" + name + "'; commands: " + known + " ('kokage --help' tells more)";
}

/// What every command takes, before its name or after it.
struct GeneralOptions {
    bool quiet = false;
    int threads = 0;
};

void add_general_options(CLI::App& app, GeneralOptions& options) {
    app.add_flag("--quiet", options.quiet, "Print no progress and no summary, only warnings and errors")
        ->group("General");
    app.add_option("--threads", options.threads, "Threads to use; 0 = as many as the machine has")
        ->check(CLI::Range(0, 4096).description(""))
        ->type_name("N")
        ->capture_default_str()
        ->group("General");
}

int run_command(const Command& command, const GeneralOptions& options) {
    set_thread_count(options.threads);
    TerminalProgress progress(!options.quiet && stderr_is_terminal());
    try {
        command.run({.quiet = options.quiet, .threads = options.threads, .progress = &progress});
        std::cout.flush();
        return std::cout ? 0 : complain("the output could not be written (is the disk full?)", kInternalError);
    } catch (const StoppedBetweenFiles& stopped) {
        progress.clear();
        return complain("stopped; " + stopped.kept, kStopped);
    } catch (const Stopped&) {
        progress.clear();
        return complain("stopped; nothing was written", kStopped);
    } catch (const InputError& error) {
        progress.clear();
        return complain(error.what(), kInputError);
    } catch (
        const std::filesystem::filesystem_error& error) { // a place that the system refuses: too long, no permission
        progress.clear();
        return complain("'" + error.path1().string() + "': " + error.code().message(), kInputError);
    } catch (const std::bad_alloc&) {
        progress.clear();
        return complain(kNotEnoughMemory, kInputError);
    } catch (const std::length_error&) { // more elements than an array can have at all
        progress.clear();
        return complain(kNotEnoughMemory, kInputError);
    } catch (const std::exception& error) {
        progress.clear();
        return complain(error.what(), kInternalError);
    }
}

} // namespace

int run_program(int argc, const char* const* argv) {
    keep_freed_memory();
    watch_stop_signals(); // first of all: nobody knows when Ctrl-C comes
    CLI::App program("Fast, accurate shading of trees: the light on every leaf, from the crown's edge to its core.",
                     "kokage");
    program.set_version_flag("--version", "kokage " KOKAGE_VERSION);
    program.footer("\n'kokage COMMAND --help' tells a command's options.");
    program.formatter(std::make_shared<WrappedFormatter>());
    const std::vector<Command> commands = all_commands(program);
    GeneralOptions general;
    add_general_options(program, general);
    for (const Command& command : commands)
        add_general_options(*command.app, general);
    program.require_subcommand(0, 1);
    try {
        program.parse(argc, argv);
    } catch (const CLI::Success& help) {
        if (const auto name = unknown_command(program))
            return complain(no_such_command(*name, commands), kInputError);
        return program.exit(help);
    } catch (const CLI::ParseError& error) {
        if (const auto name = unknown_command(program))
            return complain(no_such_command(*name, commands), kInputError);
        const std::vector<CLI::App*> asked = program.get_subcommands();
        return complain(std::string(error.what()) + " ('kokage " +
                            (asked.empty() ? "" : asked.front()->get_name() + " ") + "--help' tells more)",
                        kInputError);
    }
    for (const Command& command : commands) {
        if (!command.app->parsed())
            continue;
        if (program.count("--threads") > 0 && command.app->count("--threads") > 0)
            return complain("--threads: it stands before and after the command; leave one of them out", kInputError);
        return run_command(command, general);
    }
    std::cout << program.help();
    return 0;
}

} // namespace kokage
