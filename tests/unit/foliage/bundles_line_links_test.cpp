// Fragments in order of depth, links from them and rows of links, against slow twins.
#include "common/services/random.h"
#include "foliage/bundles/bundle_tracing.h"
#include "foliage/bundles/line_links.h"
#include "tests/support/instruction_sets.h"
#include "tests/unit/foliage/small_trees.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <numeric>

namespace kokage {
namespace {

using namespace bundles;

/// Some pixels hold nothing, most a few fragments, one more than is sorted in vectors.
TEST(BundlesLineLinks, FragmentsAreSortedAsByTheTwin) {
    constexpr std::size_t kPixels = 20 * FragmentLists::kGroup;
    constexpr std::uint32_t kFaces = 256;
    std::vector<std::uint32_t> pixels, keys;
    std::map<std::uint32_t, std::vector<std::uint32_t>> twin;
    Random random(7, 0);
    for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel) {
        const std::uint32_t group = pixel / std::uint32_t(FragmentLists::kGroup);
        const std::uint32_t count = pixel == 37 ? 53 : std::uint32_t(random.uniform() * float(group));
        for (std::uint32_t i = 0; i < count; ++i) {
            pixels.push_back(pixel);
            keys.push_back(std::uint32_t(random.uniform() * 1e6f) * kFaces + std::uint32_t(random.uniform() * kFaces));
        }
    }
    for (std::size_t i = pixels.size(); i > 1; --i) // drawing order
        std::swap(pixels[i - 1], pixels[std::size_t(random.uniform() * float(i))]);
    for (std::size_t i = 0; i < pixels.size(); ++i)
        twin[pixels[i]].push_back(keys[i]);
    std::vector<std::uint32_t> twin_near(kFaces, 0), twin_far(kFaces, 0);
    for (auto& [pixel, list] : twin) {
        std::sort(list.begin(), list.end());
        ++twin_near[list.front() % kFaces];
        ++twin_far[list.back() % kFaces];
    }
    FragmentLists lists;
    test::with_every_instruction_set([&] {
        std::vector<std::uint32_t> near_count(kFaces, 0), far_count(kFaces, 0);
        sort_fragments(kPixels, pixels, keys, kFaces - 1, lists, near_count, far_count);
        for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel) {
            const std::vector<std::uint32_t>& expected = twin[pixel];
            ASSERT_EQ(lists.count(pixel), expected.size()) << pixel;
            for (std::uint32_t i = 0; i < expected.size(); ++i)
                ASSERT_EQ(lists.key(pixel, i), expected[i]) << pixel << " " << i;
        }
        EXPECT_EQ(near_count, twin_near);
        EXPECT_EQ(far_count, twin_far);
    });
}

TEST(BundlesLineLinks, NoFragmentsMakeEmptyLists) {
    FragmentLists lists;
    std::vector<std::uint32_t> none;
    sort_fragments(2 * FragmentLists::kGroup, {}, {}, 1, lists, none, none);
    for (std::size_t pixel = 0; pixel < 2 * FragmentLists::kGroup; ++pixel)
        EXPECT_EQ(lists.count(pixel), 0u);
}

/// Leaves, and rectangles of bark whose insides lines meet, too.
PatchScene linked_leaves_and_bark() {
    PatchScene scene = test::random_crown(200, 2, test::realistic_leaf());
    for (int i = 0; i < 6; ++i) {
        test::add_rectangle(scene, {0.2f * float(i) - 0.5f, 1, 0.1f * float(i)}, {0.3f, 0, 0.1f * float(i)},
                            {0, 2, 0.1f});
        scene.patches.back().kind = PatchKind::bark;
        --scene.leaf_count;
    }
    return scene;
}

using SidePair = std::pair<std::uint32_t, std::uint32_t>;

TEST(BundlesLineLinks, GroundTexelsAreWhereTheySay) {
    const Facets facets = make_facets(linked_leaves_and_bark());
    for (const auto& [directions, size] : {std::pair(2, 32), {64, 32}, {256, 64}, {1024, 128}, {20000, 128}}) {
        const GroundGrid grid = make_ground_grid(facets, 0, directions);
        ASSERT_EQ(grid.size, size) << directions;
        for (std::uint32_t texel = 0; texel < grid.texels(); ++texel) {
            const glm::vec2 centre = grid.centre_of(texel);
            ASSERT_EQ(grid.texel_at(centre.x, centre.y), int(texel));
        }
        const float reach = grid.texel * float(grid.size);
        EXPECT_EQ(grid.texel_at(grid.low.x - 0.01f * reach, grid.low.y + 0.5f * reach), -1);
        EXPECT_EQ(grid.texel_at(grid.low.x + 0.5f * reach, grid.low.y + 1.01f * reach), -1);
    }
}

TEST(BundlesLineLinks, LinksAreThoseOfASlowWalkAlongTheLines) {
    const PatchScene scene = linked_leaves_and_bark();
    const Facets facets = make_facets(scene);
    const GroundGrid grid = make_ground_grid(facets, 0, 40);
    const std::uint32_t face_mask = (1u << face_bits(facets)) - 1;
    for (const glm::vec3& direction :
         {glm::normalize(glm::vec3(0.3f, -0.8f, 0.4f)), glm::normalize(glm::vec3(-0.5f, -0.5f, 0.6f))})
        for (std::uint32_t phase : {0u, 1u, 2u, 3u})
            test::with_every_instruction_set([&] {
                const Projection projection = fit_projection(facets, direction, 250, {0.3f, 0.6f});
                RasterScratch raster;
                draw_fragments(scene, facets, projection, raster);
                std::vector<std::uint32_t> sides;
                near_sides(facets, leaf_planes(facets), direction, sides);
                DirectionLinks links;
                collect_links(raster, facets, projection, sides, grid, phase, links);

                std::vector<SidePair> expected, found;
                std::vector<SidePair> ground_expected, ground_found;
                const GroundProjection on_ground = project_to_ground(grid, projection);
                ASSERT_TRUE(on_ground.valid);
                std::size_t inside_seen = 0;
                for (int y = 0; y < projection.height; ++y)
                    for (int x = 0; x < projection.width; ++x) {
                        const std::size_t pixel = std::size_t(y) * std::size_t(projection.width) + std::size_t(x);
                        std::optional<Side> open;
                        const auto inside = [&](Side side) {
                            return side % 2 == 1 && scene.patches[side / 2].kind == PatchKind::bark;
                        };
                        for (std::uint32_t i = 0; i < raster.lists.count(pixel); ++i) {
                            const std::uint32_t face = raster.lists.key(pixel, i) & face_mask;
                            Side near;
                            if (face < facets.leaf_facet_count) {
                                const Facet& facet = facets.facets[face];
                                near = 2 * facet.patch + Side(glm::dot(facet.normal, direction) >= 0);
                            } else {
                                const std::uint32_t bark = face - facets.leaf_facet_count;
                                near = 2 * facets.facets[facets.leaf_facet_count + bark / 2].patch + bark % 2;
                            }
                            if (open && !(inside(*open) && inside(near)))
                                expected.push_back({*open, near});
                            inside_seen += open && inside(*open) != inside(near);
                            open = near ^ 1u;
                        }
                        const bool followed =
                            (std::uint32_t(x) + phase) % 2 == 0 && (std::uint32_t(y) + phase / 2) % 2 == 0;
                        if (!open || inside(*open) || !followed)
                            continue;
                        const glm::vec2 hit =
                            on_ground.origin + float(x) * on_ground.along_u + float(y) * on_ground.along_v;
                        if (const int texel = grid.texel_at(hit.x, hit.y); texel >= 0)
                            ground_expected.push_back({*open, std::uint32_t(texel)});
                    }
                EXPECT_GT(expected.size(), 1000u);
                EXPECT_GT(inside_seen, 50u) << "leaves must see the inside of wood somewhere";
                EXPECT_GT(ground_expected.size(), 100u);
                ASSERT_EQ(links.a.size(), links.b.size());
                for (std::size_t i = 0; i < links.a.size(); ++i) {
                    const FacingSide a{links.a[i]}, b{links.b[i]};
                    EXPECT_EQ(a.inside_wood(),
                              a.side() % 2 == 1 && scene.patches[a.side() / 2].kind == PatchKind::bark);
                    found.push_back({a.side(), b.side()});
                }
                for (const Links::GroundLink& link : links.ground)
                    ground_found.push_back({link.side, link.texel});
                for (auto* pairs : {&expected, &found, &ground_expected, &ground_found})
                    std::sort(pairs->begin(), pairs->end());
                EXPECT_EQ(found, expected);
                EXPECT_EQ(ground_found, ground_expected);
            });
}

TEST(BundlesLineLinks, RowsLieByLengthWithinBlocks) {
    constexpr std::size_t kSides = 2 * Links::kBlock + 777;
    std::vector<std::uint32_t> first(kSides), second(kSides);
    Random random(11, 0);
    for (std::size_t side = 0; side < kSides; ++side) {
        first[side] = std::uint32_t(random.uniform() * 12);
        second[side] = std::uint32_t(random.uniform() * (side % 100 == 0 ? 90 : 12));
    }
    Links links;
    links.lay_out(first, second);
    ASSERT_EQ(links.side_count(), kSides);
    EXPECT_EQ(links.neighbours.size(),
              std::accumulate(first.begin(), first.end(), 0u) + std::accumulate(second.begin(), second.end(), 0u));
    std::vector<int> met(kSides, 0);
    for (std::size_t place = 0; place < kSides; ++place) {
        const std::size_t block = place / Links::kBlock * Links::kBlock, side = block + links.side_at[place];
        ASSERT_LT(side, std::min(block + Links::kBlock, kSides));
        ++met[side];
        ASSERT_EQ(links.place(Side(side)), place);
        EXPECT_EQ(links.half_row(Side(side), 0).size(), first[side]);
        EXPECT_EQ(links.half_row(Side(side), 1).size(), second[side]);
        EXPECT_EQ(links.row(Side(side)).size(), first[side] + second[side]);
        const std::uint32_t before = place > block ? links.begin[place] - links.begin[place - 1] : 0;
        EXPECT_LE(std::min(before, 63u), std::min(links.begin[place + 1] - links.begin[place], 63u));
    }
    EXPECT_EQ(std::count(met.begin(), met.end(), 1), std::ptrdiff_t(kSides)) << "each side has one place";
}

} // namespace
} // namespace kokage
