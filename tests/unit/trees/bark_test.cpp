#include "tests/unit/trees/growth_shape.h"
#include "trees/growth.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <functional>
#include <gtest/gtest.h>
#include <map>
#include <set>

namespace kokage {
namespace {

using Mesh = OpenMesh::TriMesh_ArrayKernelT<>;

Tree oak(int leaves) {
    GrowthParameters parameters = oak_parameters();
    parameters.leaves = leaves;
    return grow(parameters);
}

/// The bark with vertices of the same place made one: the texture's seams cut it open, in space it is closed.
struct WeldedBark {
    Mesh mesh;
    std::vector<Mesh::FaceHandle> faces;

    explicit WeldedBark(const TreePart& bark) {
        std::map<std::array<float, 3>, Mesh::VertexHandle> places;
        std::vector<Mesh::VertexHandle> vertices;
        for (const glm::vec3& p : bark.positions) {
            const auto [entry, is_new] = places.try_emplace({p.x, p.y, p.z});
            if (is_new)
                entry->second = mesh.add_vertex({p.x, p.y, p.z});
            vertices.push_back(entry->second);
        }
        for (const glm::uvec3& t : bark.triangles)
            faces.push_back(mesh.add_face(vertices[t.x], vertices[t.y], vertices[t.z]));
    }
};

TEST(Bark, IsAClosedManifold) {
    const Tree tree = oak(3000);
    const WeldedBark bark(all_bark(tree));
    for (const Mesh::FaceHandle face : bark.faces)
        ASSERT_TRUE(face.is_valid()) << "OpenMesh takes manifold faces only";
    for (const auto edge : bark.mesh.edges())
        ASSERT_FALSE(bark.mesh.is_boundary(edge));
    for (const auto vertex : bark.mesh.vertices())
        ASSERT_TRUE(bark.mesh.is_manifold(vertex));
    // Every branch is one sphere: V - E + F = 2 each.
    const std::ptrdiff_t euler = std::ptrdiff_t(bark.mesh.n_vertices()) - std::ptrdiff_t(bark.mesh.n_edges()) +
                                 std::ptrdiff_t(bark.mesh.n_faces());
    EXPECT_EQ(euler, 2 * std::ptrdiff_t(tree.skeleton.branches.size()));
}

TEST(Bark, HasNoDegenerateTrianglesAndFacesOutwards) {
    const Tree tree = oak(5000);
    const TreePart bark = all_bark(tree);
    double volume = 0;
    std::size_t agree = 0;
    for (const glm::uvec3& t : bark.triangles) {
        ASSERT_GT(triangle_area(bark, t), 1e-10);
        const glm::dvec3 a(bark.positions[t.x]), b(bark.positions[t.y]), c(bark.positions[t.z]);
        volume += glm::dot(a, glm::cross(b, c)) / 6;
        const glm::vec3 geometric =
            glm::cross(bark.positions[t.y] - bark.positions[t.x], bark.positions[t.z] - bark.positions[t.x]);
        agree += glm::dot(geometric, bark.normals[t.x] + bark.normals[t.y] + bark.normals[t.z]) > 0;
    }
    EXPECT_GT(double(agree), 0.97 * double(bark.triangles.size()));
    // The volume of the wood, from the skeleton's frusta; tubes of few sides hold less (3 sides: 0.41 of a cylinder),
    // roots add some.
    double wood = 0;
    for (const Branch& branch : tree.skeleton.branches)
        for (std::size_t i = 0; i + 1 < branch.nodes.size(); ++i) {
            const double r = branch.nodes[i].radius_m, s = branch.nodes[i + 1].radius_m;
            wood += kPiDouble / 3 * (r * r + r * s + s * s) *
                    glm::distance(branch.nodes[i].position, branch.nodes[i + 1].position);
        }
    EXPECT_GT(volume, 0.6 * wood);
    EXPECT_LT(volume, 1.5 * wood);
}

TEST(Bark, PatchesAreConsecutiveAndSmall) {
    const Tree tree = oak(30000);
    const TreePart bark = all_bark(tree);
    EXPECT_GT(bark.triangles.size(), tree.leaves.size());
    EXPECT_LT(bark.triangles.size(), 3 * tree.leaves.size());
    std::set<std::uint32_t> seen;
    for (std::size_t t = 0; t < bark.triangles.size(); ++t) {
        const bool begins = t == 0 || bark.triangle_patch[t] != bark.triangle_patch[t - 1];
        ASSERT_TRUE(!begins || seen.insert(bark.triangle_patch[t]).second)
            << "patch " << bark.triangle_patch[t] << " is torn apart";
    }
    EXPECT_EQ(seen.size(), tree.bark_patch_count);
    EXPECT_EQ(*seen.rbegin() + 1, tree.bark_patch_count);
    std::vector<double> areas(tree.bark_patch_count, 0.0);
    for (std::size_t t = 0; t < bark.triangles.size(); ++t)
        areas[bark.triangle_patch[t]] += triangle_area(bark, bark.triangles[t]);
    std::sort(areas.begin(), areas.end(), std::greater<>());
    EXPECT_LT(areas[1], 0.15) << "all but the foot of the trunk, which stands on the ground";
    const auto thick = std::size_t(
        std::count_if(tree.skeleton.branches.begin(), tree.skeleton.branches.end(), [](const Branch& branch) {
            return branch.nodes[std::min<std::size_t>(1, branch.nodes.size() - 1)].radius_m > 0.02f;
        }));
    EXPECT_LT(thick, 150u);
    EXPECT_LT(areas[thick + 1], 0.06) << "all but the feet of thick branches, which are hidden in their parents";
}

TEST(Bark, TextureIsNotStretched) {
    const Tree tree = oak(30000);
    const TreePart bark = all_bark(tree);
    double area = 0, stretched = 0;
    for (const glm::uvec3& t : bark.triangles) {
        const double here = triangle_area(bark, t);
        area += here;
        stretched += texture_stretch(bark, t) > 2.5 ? here : 0;
    }
    EXPECT_LT(stretched, 0.2 * area);
}

TEST(Bark, StandsOnTheGround) {
    const Tree tree = oak(3000);
    float lowest = 1e30f;
    for (const glm::vec3& p : all_bark(tree).positions)
        lowest = std::min(lowest, p.y);
    EXPECT_NEAR(lowest, 0.f, 1e-6f);
}

} // namespace
} // namespace kokage
