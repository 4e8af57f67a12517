// The rasters of the lines against a slow twin: every pixel centre against every polygon, in double precision.
#include "foliage/bundles/line_raster.h"
#include "tests/support/instruction_sets.h"
#include "tests/unit/foliage/small_trees.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <set>

namespace kokage {
namespace {

using namespace bundles;

/// A convex polygon in the picture: corners in pixels, depth as a plane over them.
struct TwinPolygon {
    std::vector<glm::dvec2> corners;
    glm::dvec3 depth{0.0}; ///< depth = x + y u + z v
    double slope = 0, facing = 0;
    std::uint32_t face = 0;
    const AlphaMask* mask = nullptr;
    glm::dvec3 texture_u{0.0}, texture_v{0.0}; ///< as planes over the picture
};

/// A quantity with the given values at three points as a plane over the picture.
glm::dvec3 plane(const glm::dvec2 (&p)[3], const glm::dvec3& values) {
    const double determinant = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[2].x - p[0].x) * (p[1].y - p[0].y);
    const double du =
        ((values[1] - values[0]) * (p[2].y - p[0].y) - (values[2] - values[0]) * (p[1].y - p[0].y)) / determinant;
    const double dv =
        ((values[2] - values[0]) * (p[1].x - p[0].x) - (values[1] - values[0]) * (p[2].x - p[0].x)) / determinant;
    return {values[0] - du * p[0].x - dv * p[0].y, du, dv};
}
double at(const glm::dvec3& over_picture, double u, double v) {
    return over_picture.x + over_picture.y * u + over_picture.z * v;
}

/// Polygons of a scene whose triangles come in pairs (rectangles of add_rectangle), straight from its positions.
std::vector<TwinPolygon> project(const PatchScene& scene, const Facets& facets, const Projection& projection) {
    std::vector<TwinPolygon> polygons;
    std::uint32_t bark = 0;
    for (std::uint32_t p = 0; p < scene.patches.size(); ++p) {
        const Patch& patch = scene.patches[p];
        for (std::uint32_t t = patch.first_triangle; t < patch.first_triangle + patch.triangle_count; t += 2) {
            const std::uint32_t index[4] = {scene.triangles[t].x, scene.triangles[t].y, scene.triangles[t].z,
                                            scene.triangles[t + 1].z};
            TwinPolygon polygon;
            glm::dvec3 corner[4], depths;
            for (int k = 0; k < 4; ++k) {
                corner[k] = (glm::dvec3(scene.positions[index[k]]) - facets.centre) * facets.scale *
                            double(projection.pixels_per_unit);
                polygon.corners.push_back(
                    {glm::dot(glm::dvec3(projection.u_axis), corner[k]) + double(projection.offset.x),
                     glm::dot(glm::dvec3(projection.v_axis), corner[k]) + double(projection.offset.y)});
                if (k < 3)
                    depths[std::size_t(k)] = glm::dot(glm::dvec3(projection.direction), corner[k]);
            }
            const glm::dvec3 normal = glm::normalize(glm::cross(corner[1] - corner[0], corner[2] - corner[0]));
            polygon.facing = glm::dot(normal, glm::dvec3(projection.direction));
            const glm::dvec2 three[3] = {polygon.corners[0], polygon.corners[1], polygon.corners[2]};
            polygon.depth = plane(three, depths);
            polygon.slope = std::hypot(polygon.depth.y, polygon.depth.z);
            polygon.face = patch.kind == PatchKind::leaf
                               ? p
                               : facets.leaf_facet_count + 2 * bark + std::uint32_t(polygon.facing > 0);
            if (scene.masked(t)) {
                polygon.mask = &scene.masks[std::size_t(scene.triangle_mask[t])];
                glm::dvec3 u, v;
                for (std::size_t k = 0; k < 3; ++k) {
                    u[k] = scene.uvs[index[k]].x;
                    v[k] = scene.uvs[index[k]].y;
                }
                polygon.texture_u = plane(three, u);
                polygon.texture_v = plane(three, v);
            }
            polygons.push_back(std::move(polygon));
        }
        bark += patch.kind == PatchKind::bark;
    }
    return polygons;
}

enum class Cover { no, yes, too_close_to_call };

Cover covers(const TwinPolygon& polygon, double u, double v) {
    constexpr double kNear = 2e-3; // pixels; what single precision may lose
    double nearest = 1e30;
    for (std::size_t k = 0; k < polygon.corners.size(); ++k) {
        const glm::dvec2 a = polygon.corners[k], edge = polygon.corners[(k + 1) % polygon.corners.size()] - a;
        const double side = (edge.x * (v - a.y) - edge.y * (u - a.x)) / glm::length(edge);
        nearest = std::min(nearest, polygon.facing < 0 ? side : -side);
    }
    if (nearest < -kNear)
        return Cover::no;
    // The raster leaves out what stands within 0.004 of edge-on.
    if (nearest < kNear || std::abs(polygon.facing) < 0.005)
        return Cover::too_close_to_call;
    if (!polygon.mask)
        return Cover::yes;
    const double s = at(polygon.texture_u, u, v), t = at(polygon.texture_v, u, v);
    const double size = polygon.mask->alpha->width;
    if (std::abs(s * size - std::round(s * size)) < 0.01 || std::abs(t * size - std::round(t * size)) < 0.01)
        return Cover::too_close_to_call;
    return polygon.mask->solid({float(s), float(t)}) ? Cover::yes : Cover::no;
}

struct TwinFragment {
    double depth, tolerance;
    std::uint32_t face;
};

/// Compares both rasters with the twin, pixel by pixel; pixels that rounding may decide either way are left out.
void expect_same_as_twin(const PatchScene& scene, const glm::vec3& direction, float density) {
    const Facets facets = make_facets(scene);
    const Projection projection = fit_projection(facets, direction, density, {0.3f, 0.7f});
    const std::vector<TwinPolygon> polygons = project(scene, facets, projection);
    RasterScratch ends, lists;
    draw_ends(scene, facets, projection, true, ends);
    draw_fragments(scene, facets, projection, lists);
    const std::uint32_t face_mask = (1u << face_bits(facets)) - 1;
    const double quantum =
        double(projection.depth_high - projection.depth_low) * (double(face_mask) + 1) / 4294967296.0;

    std::vector<std::uint32_t> least(facets.face_count(), 0), most(facets.face_count(), 0);
    std::size_t compared = 0, doubtful_cover = 0, doubtful_order = 0, covered = 0;
    std::vector<TwinFragment> fragments;
    for (int y = 0; y < projection.height; ++y)
        for (int x = 0; x < projection.width; ++x) {
            fragments.clear();
            bool doubtful = false;
            for (const TwinPolygon& polygon : polygons) {
                const Cover cover = covers(polygon, x, y);
                most[polygon.face] += cover != Cover::no;
                least[polygon.face] += cover == Cover::yes;
                doubtful |= cover == Cover::too_close_to_call;
                if (cover == Cover::yes)
                    fragments.push_back(
                        {at(polygon.depth, x, y), 2 * quantum + 2e-4 * (1 + polygon.slope), polygon.face});
            }
            if (doubtful) {
                ++doubtful_cover;
                continue;
            }
            covered += !fragments.empty();
            std::sort(fragments.begin(), fragments.end(),
                      [](const TwinFragment& a, const TwinFragment& b) { return a.depth < b.depth; });
            const std::size_t pixel = std::size_t(y) * std::size_t(projection.width) + std::size_t(x);
            ASSERT_EQ(lists.lists.count(pixel), fragments.size()) << x << " " << y;
            bool order_known = true;
            for (std::size_t i = 1; i < fragments.size(); ++i)
                order_known &=
                    fragments[i].depth - fragments[i - 1].depth > fragments[i].tolerance + fragments[i - 1].tolerance;
            if (!order_known) {
                ++doubtful_order;
                continue;
            }
            for (std::size_t i = 0; i < fragments.size(); ++i)
                ASSERT_EQ(lists.lists.key(pixel, std::uint32_t(i)) & face_mask, fragments[i].face)
                    << x << " " << y << " " << i;
            if (fragments.empty()) {
                ASSERT_EQ(ends.near_keys[pixel], kNoKey);
                ASSERT_EQ(ends.far_keys[pixel], 0u);
            } else {
                ASSERT_EQ(ends.near_keys[pixel] & face_mask, fragments.front().face) << x << " " << y;
                ASSERT_EQ(ends.far_keys[pixel] & face_mask, fragments.back().face) << x << " " << y;
            }
            ++compared;
        }
    EXPECT_GT(covered, 500u);
    EXPECT_LT(double(doubtful_cover), 0.15 * double(compared)) << "the comparison must mean something";
    EXPECT_LT(double(doubtful_order), 0.03 * double(compared));

    EXPECT_EQ(ends.fragments, lists.fragments);
    EXPECT_EQ(ends.near_count, lists.near_count);
    EXPECT_EQ(ends.far_count, lists.far_count);
    std::size_t sum = 0;
    for (std::uint32_t face = 0; face < facets.face_count(); ++face) {
        EXPECT_GE(ends.fragments[face], least[face]) << face;
        EXPECT_LE(ends.fragments[face], most[face]) << face;
        sum += ends.fragments[face];
    }
    EXPECT_EQ(sum, lists.fragment_count);
}

/// A closed prism of `walls` rectangles around a segment, one patch of bark.
void add_tube(PatchScene& scene, const glm::vec3& foot, const glm::vec3& axis, float radius, int walls) {
    const glm::vec3 u = glm::normalize(glm::cross(axis, glm::vec3(0.3f, 0.2f, 1))),
                    v = glm::normalize(glm::cross(axis, u));
    std::vector<glm::vec3> corners;
    for (int i = 0; i < walls; ++i) {
        const float a = 2 * kPi * float(i) / float(walls), b = 2 * kPi * float(i + 1) / float(walls);
        const glm::vec3 p = foot + radius * (std::cos(a) * u + std::sin(a) * v),
                        q = foot + radius * (std::cos(b) * u + std::sin(b) * v);
        corners.insert(corners.end(), {p, q, q + axis, p, q + axis, p + axis});
    }
    test::add_leaf(scene, corners);
    scene.patches.back().kind = PatchKind::bark;
    --scene.leaf_count;
}

PatchScene drawn_leaves_and_bark() {
    PatchScene scene = test::random_crown(120, 2, test::realistic_leaf());
    add_tube(scene, {0, 1, 0}, {0.1f, 1.6f, 0.2f}, 0.1f, 6);
    add_tube(scene, {0.2f, 1.5f, 0.1f}, {0.7f, 0.4f, -0.3f}, 0.05f, 5);
    return scene;
}

const glm::vec3 kDirections[] = {glm::normalize(glm::vec3(0.3f, -0.8f, 0.4f)),
                                 {0, -1, 0},
                                 {-1, 0, 0},
                                 glm::normalize(glm::vec3(-0.5f, -0.1f, -0.7f))};

TEST(BundlesLineRaster, LeavesAreDrawnAsByTheTwin) {
    const PatchScene scene = test::random_crown(150, 3, test::realistic_leaf());
    for (const glm::vec3& direction : kDirections)
        expect_same_as_twin(scene, direction, 60);
}

TEST(BundlesLineRaster, BarkHasAFaceForEachEndOfTheLine) {
    for (const glm::vec3& direction : kDirections)
        expect_same_as_twin(drawn_leaves_and_bark(), direction, 70);
}

/// Only the part of it that lines through the rest pass.
TEST(BundlesLineRaster, AWideFloorIsCutOff) {
    PatchScene scene = drawn_leaves_and_bark();
    test::add_rectangle(scene, {-20, -1, -20}, {0, 0, 40}, {40, 0, 0});
    test::add_rectangle(scene, {-20, -1, 2}, {0, 4, 0}, {40, 0, 0});
    for (std::size_t p = scene.patches.size() - 2; p < scene.patches.size(); ++p)
        scene.patches[p].kind = PatchKind::bark;
    scene.leaf_count -= 2;
    const Facets facets = make_facets(scene);
    ASSERT_EQ(facets.wide_patches.size(), 2u);
    const Projection projection = fit_projection(facets, {0, -1, 0}, 1000, {0, 0});
    ASSERT_TRUE(projection.clips);
    EXPECT_LT(std::max(projection.width, projection.height), 250); // of more than 1000
    for (const glm::vec3& direction : kDirections)
        expect_same_as_twin(scene, direction, 1000);
}

TEST(BundlesLineRaster, HolesOfCardsLetLinesThrough) {
    PatchScene scene = test::random_crown(40, 3, test::realistic_leaf());
    test::mask_rectangles(scene, test::checkered_mask(4));
    for (const glm::vec3& direction : kDirections)
        expect_same_as_twin(scene, direction, 90);
}

TEST(BundlesLineRaster, TexturesThatAreLeftRepeat) {
    PatchScene scene = test::random_crown(40, 3, test::realistic_leaf());
    AlphaMask mask = test::checkered_mask(4);
    test::mask_rectangles(scene, mask);
    mask.wrap_u = TextureWrap::mirror;
    mask.wrap_v = TextureWrap::clamp;
    scene.masks.push_back(mask);
    for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
        const std::size_t leaf = t / 2;
        scene.triangle_mask[t] = std::int16_t(leaf % 2);
        if (t % 2 == 0 && leaf % 3 > 0)
            for (std::size_t k = 0; k < 6; ++k)
                scene.uvs[6 * leaf + k] = 2.3f * scene.uvs[6 * leaf + k] - glm::vec2(0.6f, 0.4f);
    }
    for (const glm::vec3& direction : kDirections)
        expect_same_as_twin(scene, direction, 90);
}

TEST(BundlesLineRaster, MasksOfAnySizeAreDrawnWithTheirOwn) {
    PatchScene scene = test::random_crown(40, 3, test::realistic_leaf());
    test::mask_rectangles(scene, test::half_mask());
    Random random(5);
    Image alpha(45, 45, 1); // rows that end within a word
    for (float& value : alpha.pixels)
        value = random.uniform();
    scene.masks.push_back({std::make_shared<const Image>(alpha), 0.6f, TextureWrap::repeat, TextureWrap::repeat});
    for (std::size_t t = 0; t < scene.triangles.size(); ++t)
        scene.triangle_mask[t] = std::int16_t(t / 2 % 2);
    for (const glm::vec3& direction : kDirections)
        expect_same_as_twin(scene, direction, 200);
}

TEST(BundlesLineRaster, EveryInstructionSetDrawsTheSame) {
    test::with_every_instruction_set([&] {
        expect_same_as_twin(drawn_leaves_and_bark(), kDirections[0], 70);
        PatchScene cards = test::random_crown(30, 3, test::realistic_leaf());
        test::mask_rectangles(cards, test::half_mask());
        expect_same_as_twin(cards, kDirections[0], 90);
    });
}

// A facet's fragments stand for its projected area: many pixels tell it well.
TEST(BundlesLineRaster, FragmentsTellProjectedAreas) {
    const PatchScene scene = test::random_crown(20, 1, test::realistic_leaf());
    const Facets facets = make_facets(scene);
    for (const glm::vec3& direction : kDirections) {
        RasterScratch scratch;
        draw_ends(scene, facets, fit_projection(facets, direction, 500, {0.1f, 0.2f}), false, scratch);
        for (std::uint32_t f = 0; f < facets.facets.size(); ++f) {
            const double expected =
                500.0 * 500.0 * double(facets.facets[f].area * facets.facets[f].projected_share(direction));
            EXPECT_NEAR(scratch.fragments[f], expected, 0.01 * expected + 60) << f;
        }
    }
}

TEST(BundlesLineRaster, NothingIsDrawnOfNothing) {
    const PatchScene scene;
    const Facets facets = make_facets(scene);
    RasterScratch scratch;
    draw_fragments(scene, facets, fit_projection(facets, {0, -1, 0}, 1, {0, 0}), scratch);
    EXPECT_EQ(scratch.fragment_count, 0u);
    EXPECT_TRUE(scratch.fragments.empty());
}

} // namespace
} // namespace kokage
