// Maps compared: known differences give their known figures, in whatever containers they are.
#include "reflection/maps/compare_maps.h"

#include "common/environment/lat_long.h"
#include "common/services/error.h"

#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

/// A smooth function of direction and lobe in every texel.
template <typename Container>
FilteredMap smooth_map(Container container, float scale = 1) {
    std::vector<glm::vec3> texels(container.layout().size());
    for (std::size_t i = 0; i < texels.size(); ++i) {
        const double width = lobe_width({container.layout().kind, double(container.layout().parameters[i])});
        texels[i] = scale * (glm::vec3(0.5f) + 0.2f * float(1 - width) * container.layout().directions[i]);
    }
    container.set_texels(texels);
    return filtered_map(std::move(container));
}

FilteredMap smooth_shells(double least, double most, float scale = 1) {
    return smooth_map(ShellMap({.least_parameter = least, .most_parameter = most, .format = TexelFormat::float_rgb}),
                      scale);
}

TEST(CompareMaps, AMapAgainstItself) {
    const MapComparison c = compare_maps(smooth_shells(1, 100), smooth_shells(1, 100), 500, 5);
    EXPECT_EQ(c.lobes.size(), 5u);
    EXPECT_EQ(c.directions, 500u);
    EXPECT_EQ(c.all.max_255, 0);
    EXPECT_EQ(c.all.mean_relative, 0);
    EXPECT_EQ(c.all.max_relative, 0);
}

TEST(CompareMaps, AHundredthBrighterIsAHundredthEverywhere) {
    const MapComparison c = compare_maps(smooth_shells(1, 100, 1.01f), smooth_shells(1, 100), 2000, 5);
    EXPECT_NEAR(c.all.mean_relative.value(), 0.01, 1e-4);
    EXPECT_NEAR(c.all.max_relative.value(), 0.01, 1e-4);
    EXPECT_NEAR(c.all.mean_absolute, 0.01 * 0.5, 1e-4);
    EXPECT_LE(c.all.max_absolute, 0.01 * 0.7 * 1.01);
    EXPECT_NEAR(c.all.mean_255, 0.01 * 0.5 * 255, 0.01);
    EXPECT_GT(c.all.max_255, c.all.mean_255);
    EXPECT_LT(c.all.max_255, 0.01 * 0.7 * 255 * 1.01);
}

TEST(CompareMaps, AgainstABlackReferenceNothingIsRelative) {
    const MapComparison c = compare_maps(smooth_shells(1, 100), smooth_shells(1, 100, 0), 500, 3);
    EXPECT_FALSE(c.all.mean_relative);
    EXPECT_FALSE(c.all.max_relative);
    EXPECT_FALSE(c.lobes[1].difference.max_relative);
    EXPECT_NEAR(c.all.mean_absolute, 0.5, 0.01);
    EXPECT_GT(c.all.max_absolute, 0.55);
    EXPECT_GT(glm::length(c.all.worst_direction), 0.9f);
    EXPECT_EQ(c.worst_parameter, 100) << "where the map reaches farthest";
}

TEST(CompareMaps, LobesAreThoseThatBothHold) {
    const MapComparison c = compare_maps(smooth_shells(1, 100), smooth_shells(20, 500), 100, 3);
    EXPECT_EQ(c.lobes.front().parameter, 20);
    EXPECT_EQ(c.lobes.back().parameter, 100);
    EXPECT_EQ(compare_maps(smooth_shells(1, 100), smooth_shells(100, 100), 100, 3).lobes.size(), 1u);
    EXPECT_THROW(compare_maps(smooth_shells(1, 10), smooth_shells(11, 20)), InputError);
}

TEST(CompareMaps, AVoxelCubeIsNearTheShells) {
    const FilteredMap cube = smooth_map(VoxelCube(LobeKind::phong, RoughnessScale::solved(32, 256, 500)));
    const MapComparison c = compare_maps(cube, smooth_shells(40, 500), 2000, 5);
    EXPECT_GT(c.all.max_255, 0);
    EXPECT_LT(c.all.max_255, 2);
    EXPECT_NEAR(c.lobes.back().parameter, 500, 1e-6);
}

TEST(CompareMaps, CubeMapsAreComparedAtTheirOwnLevels) {
    PrefilteredCube cube = empty_cube({.size = 64, .kind = LobeKind::ggx, .parameters = {0, 0.3, 0.6}});
    const TexelLayout layout = filtered_layout(cube);
    std::vector<glm::vec3> texels;
    for (std::size_t i = 0; i < layout.size(); ++i)
        texels.push_back(glm::vec3(0.5f) + 0.2f * layout.directions[i]);
    set_filtered_texels(cube, texels);
    ShellMap shells({.kind = LobeKind::ggx, .least_parameter = 0.25, .most_parameter = 1});
    std::vector<glm::vec3> shell_texels;
    for (const glm::vec3& direction : shells.layout().directions)
        shell_texels.push_back(glm::vec3(0.5f) + 0.2f * direction);
    shells.set_texels(shell_texels);
    const FilteredMap a = filtered_map(cube), b = filtered_map(shells);
    for (const MapComparison& c : {compare_maps(a, b, 1000), compare_maps(b, a, 1000)}) {
        ASSERT_EQ(c.lobes.size(), 2u); // the image itself is no lobe
        EXPECT_EQ(c.lobes[0].parameter, 0.3);
        EXPECT_EQ(c.lobes[1].parameter, 0.6);
        EXPECT_LT(c.all.max_255, 0.6);
    }
    EXPECT_THROW(compare_maps(a, smooth_shells(1, 100)), InputError); // Phong
    EXPECT_THROW(filtered_map(empty_cube({.size = 8, .kind = LobeKind::ggx, .parameters = {0}})), InputError);
}

TEST(CompareMaps, PicturesShowTheMapAsTheHouseLooksAtLatLongImages) {
    const FilteredMap map = smooth_shells(1, 100);
    const Image image = lat_long_of_map(map, 30, 32);
    for (const auto& [x, y] : {std::pair{3, 2}, {20, 9}}) {
        const std::vector<glm::vec3> direction{glm::vec3(pixel_direction(x, y, 32, 16))};
        std::vector<glm::vec3> filtered(1);
        map.lookup(direction, 30, filtered);
        EXPECT_EQ(image.at(x, y)[2], filtered[0].z);
    }
}

} // namespace
} // namespace kokage
