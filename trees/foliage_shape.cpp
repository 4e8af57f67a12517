#include "trees/foliage_shape.h"

#include "common/geometry/triangle_topology.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>

namespace kokage {
namespace {

struct FoliageBox {
    glm::dvec3 low{std::numeric_limits<double>::max()}, high{std::numeric_limits<double>::lowest()};
    void add(const glm::vec3& p) {
        low = glm::min(low, glm::dvec3(p));
        high = glm::max(high, glm::dvec3(p));
    }
    double diagonal() const { return low.x <= high.x ? glm::length(high - low) : 0; }
};

struct FoliagePiece {
    FoliageBox box;
    double area = 0;
    Eigen::Matrix3d facing = Eigen::Matrix3d::Zero(); ///< sum of area n n^T

    void add(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
        for (const glm::vec3& corner : {a, b, c})
            box.add(corner);
        const glm::dvec3 cross = 0.5 * glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a));
        const double size = glm::length(cross);
        if (!(size > 0))
            return;
        const Eigen::Vector3d normal(cross.x / size, cross.y / size, cross.z / size);
        facing += size * normal * normal.transpose();
        area += size;
    }
    /// The largest eigenvalue's share is 1 for a plane seen from both sides, 1/2 for a tube, 1/3 for a ball; a leaf
    /// folded by 60 degrees has 3/4.
    bool is_flat() const {
        if (!(area > 0))
            return false;
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(facing / area, Eigen::EigenvaluesOnly);
        return solver.eigenvalues()[2] > 0.7;
    }
};

} // namespace

LoosePieces small_flat_pieces(const SceneMesh& mesh, double longest) {
    LoosePieces found;
    found.triangles.assign(mesh.triangles.size(), false);
    const std::vector<std::uint32_t> piece_of =
        connected_components(triangle_neighbours(mesh.triangles, weld(mesh.positions)));
    std::vector<FoliagePiece> pieces(piece_of.empty() ? 0 : *std::max_element(piece_of.begin(), piece_of.end()) + 1);
    for (std::size_t t = 0; t < piece_of.size(); ++t) {
        const glm::uvec3& corners = mesh.triangles[t];
        pieces[piece_of[t]].add(mesh.positions[corners.x], mesh.positions[corners.y], mesh.positions[corners.z]);
    }
    std::vector<bool> is_loose(pieces.size());
    double all = 0, loose = 0;
    for (std::size_t p = 0; p < pieces.size(); ++p) {
        is_loose[p] = pieces[p].box.diagonal() <= longest && pieces[p].is_flat();
        found.count += is_loose[p] ? 1 : 0;
        loose += is_loose[p] ? pieces[p].area : 0;
        all += pieces[p].area;
    }
    for (std::size_t t = 0; t < piece_of.size(); ++t)
        found.triangles[t] = is_loose[piece_of[t]];
    found.share = all > 0 ? loose / all : 0;
    return found;
}

double diagonal_of(const MeshScene& scene) {
    FoliageBox box;
    for (const SceneMesh& mesh : scene.meshes)
        for (const glm::uvec3& t : mesh.triangles)
            for (const std::uint32_t v : {t.x, t.y, t.z})
                box.add(mesh.positions[v]);
    return box.diagonal();
}

} // namespace kokage
