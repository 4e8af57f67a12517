#pragma once
// Tree generators by others, timed by scripts of their own (peers/) where they are installed.
#include "common/services/progress.h"
#include "tests/benchmark/tree_record.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace kokage {

struct PeerGenerator {
    std::string name;
    std::vector<std::string> command; ///< prints a tree_record_of_peer() a line, beside other text
    std::string why_not;              ///< empty if it can be run; else what is missing and how to get it
};

/// ez-tree under Node.js and Sapling in Blender, with trees of up to so many leaves.
std::vector<PeerGenerator> peer_generators(std::uint64_t most_leaves, bool quick);

/// Hands over record after record. Throws std::runtime_error if the program fails or gives none, Stopped.
void run_peer(const PeerGenerator& peer, Progress& progress, const std::function<void(const TreeRecord&)>& take);

} // namespace kokage
