#include "foliage/bundles/facets.h"
#include "tests/unit/foliage/small_trees.h"

#include <gtest/gtest.h>
#include <numeric>

namespace kokage {
namespace {

using namespace bundles;

std::size_t polygon_count(const Facets& facets) {
    std::size_t count = 0;
    for (const PolygonGroup& group : facets.groups)
        count += group.count;
    return count;
}

/// Area of polygon i of a group and whether it is convex, counter-clockwise around its normal.
double polygon_area(const PolygonGroup& group, std::size_t i) {
    auto corner = [&](int k) {
        const auto c = std::size_t(k % group.corners);
        return glm::dvec3(group.x[c][i], group.y[c][i], group.z[c][i]);
    };
    const glm::dvec3 normal(group.normal_x[i], group.normal_y[i], group.normal_z[i]);
    glm::dvec3 cross(0.0);
    for (int k = 0; k < group.corners; ++k) {
        cross += glm::cross(corner(k) - corner(0), corner(k + 1) - corner(0));
        const glm::dvec3 e = corner(k + 1) - corner(k), f = corner(k + 2) - corner(k + 1);
        EXPECT_GE(glm::dot(glm::cross(e, f), normal), -1e-3 * glm::length(e) * glm::length(f)) << "convex";
    }
    return 0.5 * glm::dot(cross, normal);
}

/// A disc of `corners` as a fan around its first corner.
void add_fan(PatchScene& scene, int corners, float lift = 0) {
    std::vector<glm::vec3> triangles;
    auto rim = [&](int i) {
        const float a = 2 * kPi * float(i) / float(corners);
        return glm::vec3(std::cos(a), 1 + (i == 2 ? lift : 0), -std::sin(a));
    };
    for (int i = 2; i < corners; ++i)
        triangles.insert(triangles.end(), {rim(0), rim(i - 1), rim(i)});
    test::add_leaf(scene, triangles);
}

TEST(BundlesFacets, FlatFansBecomeOnePolygon) {
    for (int corners = 3; corners <= PolygonGroup::kMaxCorners; ++corners) {
        PatchScene scene;
        scene.optics.resize(1);
        add_fan(scene, corners);
        const Facets facets = make_facets(scene);
        ASSERT_EQ(facets.groups.size(), 1u);
        EXPECT_EQ(facets.groups[0].corners, corners);
        EXPECT_EQ(facets.groups[0].count, 1u);
        EXPECT_NEAR(facets.facets[0].normal.y, 1, 1e-6);
        EXPECT_NEAR(polygon_area(facets.groups[0], 0), facets.facets[0].area, 1e-6);
    }
}

TEST(BundlesFacets, TooManyCornersAreSplitAndFoldsAreKept) {
    PatchScene scene;
    scene.optics.resize(1);
    add_fan(scene, 12);
    const Facets disc = make_facets(scene);
    EXPECT_EQ(disc.facets.size(), 1u) << "all in one plane";
    EXPECT_EQ(polygon_count(disc), 2u);
    PatchScene folded;
    folded.optics.resize(1);
    add_fan(folded, 4, 0.5f);
    const Facets fold = make_facets(folded);
    EXPECT_EQ(fold.facets.size(), 2u);
    EXPECT_EQ(fold.patch_first_facet, (std::vector<std::uint32_t>{0, 2}));
}

TEST(BundlesFacets, ADartIsNotMergedAcrossItsDent) {
    PatchScene scene;
    scene.optics.resize(1);
    const glm::vec3 tip(0, 0, -1), left(-1, 0, 1), dent(0, 0, 0.2f), right(1, 0, 1);
    test::add_leaf(scene, {tip, left, dent, tip, dent, right});
    const Facets facets = make_facets(scene);
    EXPECT_EQ(facets.facets.size(), 1u);
    EXPECT_EQ(polygon_count(facets), 2u);
    for (const PolygonGroup& group : facets.groups)
        for (std::size_t i = 0; i < group.count; ++i)
            polygon_area(group, i);
}

TEST(BundlesFacets, AreasAreKept) {
    const PatchScene scene = test::random_crown(300, 2, test::realistic_leaf());
    const Facets facets = make_facets(scene);
    EXPECT_EQ(polygon_count(facets), 300u);
    double drawn = 0;
    for (const PolygonGroup& group : facets.groups)
        for (std::size_t i = 0; i < group.count; ++i)
            drawn += polygon_area(group, i);
    const double total = std::accumulate(facets.patch_area.begin(), facets.patch_area.end(), 0.0);
    EXPECT_NEAR(drawn, total, 1e-5 * total);
    EXPECT_NEAR(total / (facets.scale * facets.scale), 2 * kPiDouble, 1e-4);
    EXPECT_NEAR(facets.mean_leaf_area * 300, total, 1e-5 * total);
    EXPECT_NEAR(glm::length(facets.high - facets.low), 1, 1e-5);
}

TEST(BundlesFacets, TrianglesWithoutAreaAreLeftOut) {
    PatchScene scene = test::random_crown(3, 1, test::realistic_leaf());
    test::add_leaf(scene, {{0, 2, 0}, {0, 2, 0}, {1, 2, 0}});                                     // a needle
    test::add_leaf(scene, {{0, 2, 0}, {0.5f, 2, 0}, {1, 2, 0}, {0, 2, 0}, {0, 2, 1}, {1, 2, 0}}); // half of it has area
    const Facets facets = make_facets(scene);
    EXPECT_EQ(facets.patch_first_facet, (std::vector<std::uint32_t>{0, 1, 2, 3, 3, 4}));
    EXPECT_EQ(facets.patch_area[3], 0);
    EXPECT_GT(facets.patch_area[4], 0);
    EXPECT_EQ(polygon_count(facets), 4u);
}

TEST(BundlesFacets, MasksThatDoNotContinueAreNotMerged) {
    PatchScene scene;
    scene.optics.resize(1);
    test::add_rectangle(scene, {0, 0, 0}, {1, 0, 0}, {0, 0, 1});
    test::mask_rectangles(scene, test::half_mask());
    EXPECT_EQ(polygon_count(make_facets(scene)), 1u);
    scene.uvs[5] = {0.3f, 0.2f};
    EXPECT_EQ(polygon_count(make_facets(scene)), 2u);
}

TEST(BundlesFacets, HolesHaveNoArea) {
    PatchScene scene;
    scene.optics.resize(1);
    test::add_rectangle(scene, {0, 0, 0}, {1, 0, 0}, {0, 0, 1});
    test::add_rectangle(scene, {0, 1, 0}, {1, 0, 0}, {0, 0, 1});
    test::mask_rectangles(scene, test::half_mask());
    scene.triangle_mask[2] = scene.triangle_mask[3] = -1; // the second one is whole
    const Facets facets = make_facets(scene);
    ASSERT_EQ(facets.facets.size(), 2u);
    const double to_square_metres = 1 / (facets.scale * facets.scale);
    EXPECT_NEAR(double(facets.facets[0].area) * to_square_metres, 0.5, 0.01);
    EXPECT_NEAR(double(facets.patch_area[0]) * to_square_metres, 0.5, 0.01);
    EXPECT_NEAR(double(facets.patch_area[1]) * to_square_metres, 1, 1e-5);
    EXPECT_NEAR(double(facets.mean_leaf_area) * to_square_metres, 0.75, 0.01);
    EXPECT_TRUE(facets.facets[0].masked);
    EXPECT_FALSE(facets.facets[1].masked);
}

TEST(BundlesFacets, ProjectedShareIsExactForLeavesAndCloseForTubes) {
    Random random(1);
    PatchScene scene = test::random_crown(20, 1, test::realistic_leaf());
    std::vector<glm::vec3> tube;
    constexpr int kWalls = 24;
    for (int i = 0; i < kWalls; ++i) {
        const float a = 2 * kPi * float(i) / kWalls, b = 2 * kPi * float(i + 1) / kWalls;
        const glm::vec3 p(std::cos(a), 0, -std::sin(a)), q(std::cos(b), 0, -std::sin(b)), up(0, 5, 0);
        tube.insert(tube.end(), {p, q, q + up, p, q + up, p + up});
    }
    test::add_leaf(scene, tube);
    scene.patches.back().kind = PatchKind::bark;
    const Facets facets = make_facets(scene);
    ASSERT_EQ(facets.facets.size(), 21u);
    EXPECT_EQ(facets.face_count(), 22u);
    for (int k = 0; k < 50; ++k) {
        const glm::vec3 d = test::random_direction(random);
        for (std::size_t f = 0; f < 20; ++f)
            EXPECT_NEAR(facets.facets[f].projected_share(d), std::abs(glm::dot(facets.facets[f].normal, d)), 3e-4);
        double mean = 0;
        for (int i = 0; i < kWalls; ++i) {
            const float a = 2 * kPi * (float(i) + 0.5f) / kWalls;
            mean += std::abs(double(glm::dot(glm::vec3(std::cos(a), 0, -std::sin(a)), d))) / kWalls;
        }
        EXPECT_NEAR(facets.facets[20].projected_share(d), mean, 0.02 * mean + 1e-6);
    }
}

TEST(BundlesFacets, FarAndTinySceneAreTheSameScene) {
    PatchScene scene = test::random_crown(50, 2, test::realistic_leaf());
    const Facets here = make_facets(scene);
    for (glm::vec3& position : scene.positions)
        position *= 0x1p-20f; // about a micrometre
    const Facets tiny = make_facets(scene);
    ASSERT_EQ(here.facets.size(), tiny.facets.size());
    for (std::size_t f = 0; f < here.facets.size(); ++f)
        EXPECT_NEAR(here.facets[f].area, tiny.facets[f].area, 1e-6f);
}

} // namespace
} // namespace kokage
