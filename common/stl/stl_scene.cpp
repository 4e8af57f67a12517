#include "common/stl/stl_scene.h"
#include "common/geometry/crease_normals.h"
#include "common/services/error.h"
#include "common/services/named_file.h"

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string>

namespace kokage {
namespace {

using StlMesh = OpenMesh::TriMesh_ArrayKernelT<>;

constexpr float kCrease = 40 * kPi / 180;
constexpr std::uintmax_t kHeaderBytes = 84, kTriangleBytes = 50; ///< of binary files

[[noreturn]] void fail_to_read_stl(const std::filesystem::path& path, const std::string& why) {
    throw InputError(path.string() + ": " + why);
}

/// OpenMesh joins corners that are not numbers with any other.
void check_binary(const std::filesystem::path& path, std::ifstream& file, std::uint32_t triangles) {
    char bytes[kTriangleBytes];
    for (std::uint32_t t = 0; t < triangles && file.read(bytes, kTriangleBytes); ++t) {
        float corners[9];
        std::memcpy(corners, bytes + 3 * sizeof(float), sizeof corners);
        for (const float value : corners)
            if (!std::isfinite(value))
                fail_to_read_stl(path, "triangle " + std::to_string(t) + " has a corner that is not finite");
    }
}

/// OpenMesh ends where a number can't be read.
void check_ascii(const std::filesystem::path& path, std::ifstream& file) {
    std::string line, word;
    for (std::size_t number = 1; std::getline(file, line); ++number) {
        std::istringstream words(line);
        if (!(words >> word) || word != "vertex")
            continue;
        float x = 0, y = 0, z = 0;
        if (!(words >> x >> y >> z) || !std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z))
            fail_to_read_stl(path, "line " + std::to_string(number) + ": a vertex needs three finite numbers");
    }
}

/// Before OpenMesh reads it, which takes what it can: a file that is cut off would be an empty ASCII one.
void check_file(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    char header[kHeaderBytes] = {};
    file.read(header, kHeaderBytes);
    const auto read = std::uintmax_t(file.gcount());
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (error || read == 0)
        fail_to_read_stl(path, "it can't be read, or is empty");
    std::uint32_t triangles = 0;
    std::memcpy(&triangles, header + 80, sizeof triangles);
    const bool is_binary = read == kHeaderBytes && size == kHeaderBytes + kTriangleBytes * triangles;
    if (!is_binary && std::strncmp(header, "solid", 5) != 0)
        fail_to_read_stl(path, "it is no STL, or cut off: a binary one of " + std::to_string(triangles) +
                                   " triangles has " + std::to_string(kHeaderBytes + kTriangleBytes * triangles) +
                                   " bytes, this file has " + std::to_string(size) +
                                   ", and an ASCII one begins with 'solid'");
    // An ASCII triangle takes more than 100 bytes.
    if ((is_binary ? triangles : size / 100) > kMaximumSceneTriangles)
        fail_to_read_stl(path, "it has more than " + std::to_string(kMaximumSceneTriangles) + " triangles");
    if (is_binary)
        return check_binary(path, file, triangles);
    file.clear();
    file.seekg(0);
    check_ascii(path, file);
}

StlMesh read_mesh(const std::filesystem::path& path) {
    StlMesh mesh;
    OpenMesh::IO::Options options;
    omerr().disable(); // it would tell of edges with more than two triangles, which are no fault here
    const bool is_read = OpenMesh::IO::read_mesh(mesh, path.string(), options);
    omerr().enable();
    if (!is_read || mesh.n_faces() == 0)
        fail_to_read_stl(path, "it has no triangles that can be read");
    return mesh;
}

} // namespace

MeshScene read_stl_scene(const std::filesystem::path& path) {
    check_file(path);
    const StlMesh read = read_mesh(path);
    std::vector<glm::vec3> positions;
    for (const auto vertex : read.vertices()) {
        const auto& p = read.point(vertex);
        positions.emplace_back(p[0], p[1], p[2]);
    }
    std::vector<glm::uvec3> triangles;
    for (const auto face : read.faces()) {
        glm::uvec3 corners(0);
        std::size_t k = 0;
        for (const auto vertex : face.vertices())
            corners[k++] = std::uint32_t(vertex.idx());
        triangles.push_back(corners);
    }
    CreasedMesh creased = crease_normals(positions, triangles, kCrease);
    MeshScene scene;
    SceneMaterial material;
    material.is_missing = true;
    material.double_sided = true;
    scene.materials.push_back(std::move(material));
    SceneMesh mesh;
    mesh.name = shown_name(path.stem().string());
    mesh.positions = std::move(creased.positions);
    mesh.normals = std::move(creased.normals);
    mesh.triangles = std::move(creased.triangles);
    scene.meshes.push_back(std::move(mesh));
    return scene;
}

} // namespace kokage
