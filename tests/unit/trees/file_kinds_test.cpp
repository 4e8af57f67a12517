// One tree as a file of every kind: the same triangles, normals and texture coordinates as its plain twin.
#include "common/gltf/gltf_scene.h"
#include "common/obj/obj_scene.h"
#include "tests/support/tree_file_kinds.h"
#include "trees/patches.h"
#include "trees/read_tree.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

struct Corner {
    glm::vec3 position, normal;
    glm::vec2 uv;
};
using Triangle = std::array<Corner, 3>;

MeshScene read_scene(const FileKind& kind, const std::filesystem::path& folder) {
    write_files(kind, folder);
    return kind.main.ends_with(".obj") ? read_obj_scene(folder / kind.main)
                                       : flatten(GltfDocument::read(folder / kind.main));
}

std::vector<Triangle> triangles_of(const MeshScene& scene) {
    std::vector<Triangle> triangles;
    for (const SceneMesh& mesh : scene.meshes)
        for (const glm::uvec3& t : mesh.triangles) {
            Triangle triangle;
            for (std::size_t c = 0; c < 3; ++c)
                triangle[c] = {mesh.positions[t[c]], mesh.normals[t[c]],
                               mesh.uvs.empty() ? glm::vec2(0) : mesh.uvs[t[c]]};
            triangles.push_back(triangle);
        }
    return triangles;
}

float largest(const glm::vec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// The largest difference of corners that lie in the same place, over the best rotation.
float difference(const Triangle& a, const Triangle& b) {
    float best = 1e9f;
    for (std::size_t turn = 0; turn < 3; ++turn) {
        float worst = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const Corner &x = a[c], &y = b[(c + turn) % 3];
            worst = std::max({worst, largest(x.position - y.position), largest(x.normal - y.normal),
                              largest(glm::vec3(x.uv - y.uv, 0))});
        }
        best = std::min(best, worst);
    }
    return best;
}

TEST(FileKinds, GiveTheTrianglesOfTheirPlainTwin) {
    const std::vector<FileKind> kinds = all_file_kinds();
    TemporaryFolder plain_folder;
    const std::vector<Triangle> plain = triangles_of(read_scene(kinds.front(), plain_folder.path()));
    ASSERT_EQ(plain.size(), 36u);
    for (const FileKind& kind : kinds) {
        TemporaryFolder folder;
        std::vector<Triangle> triangles = triangles_of(read_scene(kind, folder.path()));
        ASSERT_EQ(triangles.size(), plain.size()) << kind.kind;
        for (const Triangle& wanted : plain) {
            const auto nearest =
                std::min_element(triangles.begin(), triangles.end(), [&](const auto& a, const auto& b) {
                    return difference(a, wanted) < difference(b, wanted);
                });
            EXPECT_LE(difference(*nearest, wanted), kind.tolerance) << kind.kind;
            triangles.erase(nearest);
        }
    }
}

TEST(FileKinds, GiveTheSameTree) {
    const std::vector<FileKind> kinds = all_file_kinds();
    for (const FileKind& kind : kinds) {
        TemporaryFolder folder;
        write_files(kind, folder.path());
        const Tree tree = read_tree(folder / kind.main);
        EXPECT_EQ(tree.leaves.size(), 12u) << kind.kind;
        const PatchScene scene = make_patches(tree);
        validate(scene);
        ASSERT_EQ(scene.masks.size(), 1u) << kind.kind;
        // The diamond covers 112 of 256 texels.
        double area = 0, whole = 0;
        const std::vector<double> areas = solid_areas(scene);
        for (std::size_t p = 0; p < areas.size(); ++p)
            area += scene.patches[p].kind == PatchKind::leaf ? areas[p] : 0;
        for (const CardPlace& place : card_places())
            whole += double(place.scale) * double(place.scale);
        EXPECT_NEAR(area / whole, 112.0 / 256.0, 0.02) << kind.kind;
    }
}

} // namespace
} // namespace kokage
