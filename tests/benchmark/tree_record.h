#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

namespace kokage {

/// One tree that a generator made.
struct TreeRecord {
    std::string generator;       ///< "kokage", "ez-tree", "Sapling"
    std::string species;         ///< as the generator calls it
    std::uint64_t leaves = 0;    ///< outlines or cards
    std::uint64_t triangles = 0; ///< of leaves and bark
    double cpu_seconds = 0;      ///< user + system, all threads; from parameters to meshes in memory
    std::uint64_t bytes = 0;     ///< of the meshes: positions, normals, texture coordinates, triangles
    /// Of cpu_seconds, where the generator tells (ours).
    std::optional<double> skeleton_and_leaves_cpu_seconds, bark_cpu_seconds;
};

nlohmann::json to_json(const TreeRecord& record);
/// One line of a peer's script. Throws nlohmann::json::exception if it is something else.
TreeRecord tree_record_of_peer(const std::string& generator, const std::string& line);

} // namespace kokage
