#pragma once
// The subcommands of `kokage`: one function each, one file each.
#include "viewer/scene/cli_forward.h"
#include "viewer/terminal_progress.h"

#include <functional>

namespace kokage {

/// What every command is told beside its own options.
struct CommandContext {
    bool quiet = false; ///< no progress, no summary: errors and what was asked for alone
    int threads = 0;    ///< 0 = as many as the machine has; already set
    TerminalProgress* progress = nullptr;
};

/// A subcommand: `app` holds its options, `run` does the work. Throws InputError, Stopped.
struct Command {
    CLI::App* app = nullptr;
    std::function<void(const CommandContext&)> run;
};

Command grow_command(CLI::App& program);
Command describe_command(CLI::App& program);
Command shade_command(CLI::App& program);
Command render_command(CLI::App& program);
Command bake_command(CLI::App& program);
Command compare_command(CLI::App& program);
Command bench_command(CLI::App& program);

/// All that are built, in the order in which one uses them.
std::vector<Command> all_commands(CLI::App& program);

/// The program from its arguments to its exit status: 0; 1 internal error; 2 the user's input; 130 stopped by the user.
int run_program(int argc, const char* const* argv);

} // namespace kokage
