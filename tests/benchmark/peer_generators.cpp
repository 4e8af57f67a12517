#include "tests/benchmark/peer_generators.h"

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace kokage {

namespace {

/// For the shell.
std::string quoted(const std::string& word) {
    std::string text = "'";
    for (char c : word)
        text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return text + "'";
}

bool runs(const char* command) {
    return std::system((std::string(command) + " >/dev/null 2>&1").c_str()) == 0;
}

PeerGenerator ez_tree(const std::string& most_leaves, bool quick) {
    const std::filesystem::path packages = KOKAGE_BENCHMARK_NODE_PACKAGES;
    PeerGenerator peer{
        "ez-tree", {"node", std::string(KOKAGE_BENCHMARK_PEERS) + "/ez_tree.mjs", packages.string(), most_leaves}, ""};
    for (const char* preset : {"Oak Medium", "Ash Large", "Aspen Medium", "Pine Large"})
        if (!quick || peer.command.size() == 4)
            peer.command.push_back(preset);
    if (!runs("node --version"))
        peer.why_not = "Node.js is not installed (.ci/setup tests installs it)";
    else if (!std::filesystem::exists(packages / "node_modules/@dgreenheck/ez-tree"))
        peer.why_not = "its npm package is not installed (.ci/setup tests installs it)";
    return peer;
}

PeerGenerator sapling(const std::string& most_leaves, bool quick) {
    PeerGenerator peer{"Sapling",
                       {"blender", "--background", "--factory-startup", "--python",
                        std::string(KOKAGE_BENCHMARK_PEERS) + "/sapling.py", "--", most_leaves, "quaking_aspen"},
                       ""};
    if (!quick)
        for (const char* preset : {"weeping_willow", "white_birch", "japanese_maple", "douglas_fir"})
            peer.command.push_back(preset);
    if (!runs("blender --version"))
        peer.why_not = "Blender is not installed (apt-get install blender python3-numpy)";
    return peer;
}

struct ClosePipe {
    void operator()(FILE* pipe) const { pclose(pipe); }
};

} // namespace

std::vector<PeerGenerator> peer_generators(std::uint64_t most_leaves, bool quick) {
    const std::string most = std::to_string(most_leaves);
    return {ez_tree(most, quick), sapling(most, quick)};
}

void run_peer(const PeerGenerator& peer, Progress& progress, const std::function<void(const TreeRecord&)>& take) {
    std::string command;
    for (const std::string& word : peer.command)
        command += quoted(word) + " ";
    std::unique_ptr<FILE, ClosePipe> pipe(popen((command + "2>/dev/null").c_str(), "r"));
    if (!pipe)
        throw std::runtime_error("'" + peer.command.front() + "' can't be started");
    std::string line;
    std::size_t records = 0;
    for (int c; (c = std::fgetc(pipe.get())) != EOF;) {
        if (c != '\n') {
            line += char(c);
            continue;
        }
        progress.throw_if_stopped();
        if (line.starts_with("{")) { // Blender prints other lines, too
            take(tree_record_of_peer(peer.name, line));
            ++records;
        }
        line.clear();
    }
    if (pclose(pipe.release()) != 0 || records == 0)
        throw std::runtime_error("'" + peer.command.front() + "' failed; run it to see why: " + command);
}

} // namespace kokage
