#pragma once
#include <stdexcept>
#include <string>

namespace kokage {

/// Something is wrong with what the user gave. The message is one line: what, where, and how to mend it.
/// The program prints it and exits with status 2; nothing that was written before is touched.
struct InputError : std::runtime_error {
    /// Line breaks and other control characters, which names from a file may hold, become '?'.
    explicit InputError(const std::string& what) : std::runtime_error(single_line(what)) {}

  private:
    static std::string single_line(std::string text) {
        for (char& c : text)
            if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
                c = '?';
        return text;
    }
};

/// The user stopped the work (Ctrl-C). The program exits with status 130 and leaves no half-written file.
struct Stopped : std::runtime_error {
    Stopped() : std::runtime_error("stopped") {}
};

} // namespace kokage
