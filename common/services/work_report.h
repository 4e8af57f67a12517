#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace kokage {

/// What a piece of work did: how long each stage took, how much there was of each thing, and what was left out and why.
/// The program writes it as JSON (`--report`); library users read it.
struct WorkReport {
    struct Stage {
        std::string name;
        double cpu_seconds = 0, wall_seconds = 0;
    };
    struct Count {
        std::string name; ///< "leaves", "links", "rays", ...
        std::uint64_t value = 0;
    };
    struct Skip {
        std::string what, why, saved; ///< saved: what it would have cost, in words with a figure
    };
    std::vector<Stage> stages;
    std::vector<Count> counts;
    std::vector<Skip> skips;
    std::vector<std::string> warnings; ///< for the user: a setting that does not contract, a repaired input, ...

    void append(const WorkReport& other);
};

} // namespace kokage
