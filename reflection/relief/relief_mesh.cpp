#include "reflection/relief/relief_mesh.h"
#include "common/services/error.h"

#include <bit>
#include <cmath>
#include <string>
#include <unordered_map>

namespace kokage {
namespace {

struct PlaceHash {
    std::size_t operator()(const glm::uvec3& p) const {
        std::uint64_t h = 0x9e3779b97f4a7c15u;
        for (const std::uint32_t x : {p.x, p.y, p.z})
            h = (h ^ x) * 0xff51afd7ed558ccdu, h ^= h >> 32;
        return std::size_t(h);
    }
};

glm::uvec3 bits(const glm::vec3& p) { // + 0.f: the two zeros are one place
    return {std::bit_cast<std::uint32_t>(p.x + 0.f), std::bit_cast<std::uint32_t>(p.y + 0.f),
            std::bit_cast<std::uint32_t>(p.z + 0.f)};
}

bool is_finite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

} // namespace

void check_relief_mesh(const ReliefMesh& mesh, std::string_view name) {
    const std::size_t count = mesh.positions.size();
    const auto refuse = [&](const std::string& what) { throw InputError(std::string(name) + ": " + what); };
    if (mesh.uvs.empty() && count > 0)
        refuse("the mesh has no texture coordinates, and relief needs them: unwrap it, or switch its relief off");
    if (mesh.uvs.size() != count || mesh.normals.size() != count)
        refuse(std::to_string(count) + " positions, but " + std::to_string(mesh.normals.size()) + " normals and " +
               std::to_string(mesh.uvs.size()) + " texture coordinates: all must be as many");
    for (std::size_t i = 0; i < count; ++i)
        if (!is_finite(mesh.positions[i]) || !is_finite(mesh.normals[i]) || !is_finite(glm::vec3(mesh.uvs[i], 0)))
            refuse("vertex " + std::to_string(i) +
                   " has a position, normal or texture coordinate that is not a finite number");
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k)
            if (mesh.triangles[t][k] >= count)
                refuse("triangle " + std::to_string(t) + " has corner " + std::to_string(mesh.triangles[t][k]) +
                       ", but there are " + std::to_string(count) + " vertices");
}

WeldedPlaces weld_places(std::span<const glm::vec3> positions) {
    WeldedPlaces welded;
    std::unordered_map<glm::uvec3, std::uint32_t, PlaceHash> known(positions.size());
    welded.place_of_vertex.reserve(positions.size());
    for (const glm::vec3& p : positions) {
        const auto [at, is_new] = known.try_emplace(bits(p), welded.count);
        welded.count += is_new;
        welded.place_of_vertex.push_back(at->second);
    }
    return welded;
}

} // namespace kokage
