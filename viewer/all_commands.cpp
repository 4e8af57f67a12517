#include "viewer/command.h"

namespace kokage {

std::vector<Command> all_commands(CLI::App& program) {
    return {grow_command(program), describe_command(program), shade_command(program), render_command(program),
            bake_command(program), compare_command(program),  bench_command(program)};
}

} // namespace kokage
