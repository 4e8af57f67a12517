#pragma once
#include <stdexcept>
#include <string>

namespace kokage {

/// Something is wrong with what the user gave. The message is one line: what, where, and how to mend it.
/// The program prints it and exits with status 2; nothing that was written before is touched.
struct InputError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// The user stopped the work (Ctrl-C). The program exits with status 130 and leaves no half-written file.
struct Stopped : std::runtime_error {
    Stopped() : std::runtime_error("stopped") {}
};

} // namespace kokage
