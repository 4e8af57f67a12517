#include "viewer/command.h"

namespace kokage {

std::vector<Command> all_commands(CLI::App&) {
    return {};
}

} // namespace kokage
