#include "common/services/parallel.h"
#include "reflection/gathered_sums.h"
#include "reflection/light_map_readers.h"
#include "reflection/picture_memory.h"
#include "tests/unit/reflection/picture_scenes.h"

#include <fstream>
#include <gtest/gtest.h>
#include <malloc.h>
#include <optional>
#include <sstream>
#include <string>

namespace kokage::test {
namespace {

/// Of this process' memory, in bytes; empty where the system doesn't tell.
std::optional<double> memory(const std::string& name) {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.rfind(name + ":", 0) == 0)
            return 1024 * std::stod(line.substr(name.size() + 1));
    return std::nullopt;
}

/// From now on the peak is counted anew.
bool forget_peak() {
    malloc_trim(0);
    std::ofstream file("/proc/self/clear_refs");
    file << "5" << std::flush;
    return bool(file);
}

/// A field of small leaves, all of them seen from above.
PatchScene field_of_leaves(int side) {
    PatchScene scene;
    scene.optics = {{glm::vec3(0.4f), glm::vec3(0.f)}};
    for (int row = 0; row < side; ++row)
        for (int column = 0; column < side; ++column)
            add_rectangle(scene, {column, 0, row + 1}, {0.9f, 0, 0}, {0, 0, -0.9f});
    return scene;
}

TEST(PictureMemory, OfLightAndGatheringIsWhatALargeSceneTakes) {
    constexpr int kSide = 350;
    set_thread_count(2);
    for (const float reflectance : {0.f, 0.04f}) { // matt, and with lobes
        const PatchScene patches = field_of_leaves(kSide);
        ShadedScene scene = evenly_shaded(patches, glm::vec3(0.4f));
        scene.looks.resize(1);
        scene.looks[0].gloss.normal_reflectance = glm::vec3(reflectance);
        scene.looks[0].gloss.roughness = 0.6f;
        scene.triangle_look.assign(patches.triangles.size(), 0);
        const RayQueries queries(patches);
        PictureOptions options = without_ground(700, 700, 1);
        options.gather_rays = 1;
        Camera camera = camera_at({0.5f * kSide, kSide, 0.5f * kSide}, {0.5f * kSide, 0, 0.5f * kSide}, 0.9273f);
        const Environment sky = constant_environment(glm::vec3(1.f));
        render_picture(scene, queries, sky, camera, without_ground(8, 8, 1), silent_progress()); // pools and tables
        const bool can_measure = forget_peak();
        const std::optional<double> before = memory("VmRSS");
        render_picture(scene, queries, sky, camera, options, silent_progress());
        const std::optional<double> peak = memory("VmHWM");
        if (!can_measure || !before || !peak || !(*peak > *before))
            GTEST_SKIP() << "skipped: the system does not tell of peaks of memory";
        const double taken = *peak - *before, estimated = picture_bytes(options, 2) + light_bytes(options, patches, 2);
        EXPECT_GT(estimated, 0.95 * taken);
        EXPECT_LT(estimated, (reflectance > 0 ? 2 : 4.5) * taken);
    }
    set_thread_count(0);
}

/// Level rough bark, all of it one surface, lit by a light map.
struct BarkField {
    PatchScene patches;
    ShadedScene scene;

    explicit BarkField(std::uint32_t side) {
        patches.optics = {{glm::vec3(0.2f), glm::vec3(0.f)}};
        for (std::uint32_t row = 0; row <= side; ++row)
            for (std::uint32_t column = 0; column <= side; ++column)
                patches.positions.emplace_back(column, 0, row);
        for (std::uint32_t row = 0; row < side; ++row)
            for (std::uint32_t column = 0; column < side; ++column) {
                const std::uint32_t corner = row * (side + 1) + column, next = corner + side + 1;
                const auto first = std::uint32_t(patches.triangles.size()),
                           patch = std::uint32_t(patches.patches.size());
                patches.triangles.insert(patches.triangles.end(),
                                         {{corner, next, corner + 1}, {corner + 1, next, next + 1}});
                patches.triangle_patch.insert(patches.triangle_patch.end(), {patch, patch});
                patches.patches.push_back(
                    {.first_triangle = first, .triangle_count = 2, .optics = 0, .kind = PatchKind::bark, .leaf = 0});
            }
        scene = evenly_shaded(patches, glm::vec3(0.2f));
        scene.normals.assign(patches.positions.size(), glm::vec3(0, 1, 0));
        scene.looks.resize(1);
        scene.looks[0].smooth_normals = true;
        scene.looks[0].gloss.normal_reflectance = glm::vec3(0.04f);
        scene.looks[0].gloss.roughness = 0.9f;
        scene.triangle_look.assign(patches.triangles.size(), 0);
        LightMap map;
        map.coefficients.assign(std::size_t(map.bands) * std::size_t(map.bands), glm::vec3(0.f));
        map.coefficients[0] = glm::vec3(3.5f);
        scene.light_maps.maps = {map};
        scene.light_maps.per_patch = 1;
        scene.light_maps.shares.assign(patches.patches.size(), {0, 1});
    }
};

/// Of drawing, by two threads; empty where the system doesn't tell.
std::optional<double> taken_by(const BarkField& bark, const RayQueries& queries, const Camera& camera,
                               const PictureOptions& options) {
    const Environment sky = constant_environment(glm::vec3(1.f));
    set_thread_count(2);
    render_picture(bark.scene, queries, sky, camera, without_ground(8, 8, 1), silent_progress()); // pools and tables
    const bool can_measure = forget_peak();
    const std::optional<double> before = memory("VmRSS");
    render_picture(bark.scene, queries, sky, camera, options, silent_progress());
    const std::optional<double> peak = memory("VmHWM");
    set_thread_count(0);
    if (!can_measure || !before || !peak || !(*peak > *before))
        return std::nullopt;
    return *peak - *before;
}

TEST(PictureMemory, OfBarkThatReadsLightMaps) {
    constexpr std::uint32_t kSide = 250;
    BarkField bark(kSide);
    const RayQueries queries(bark.patches);
    const Camera camera = camera_at({0.5f * kSide, kSide, 0.5f * kSide}, {0.5f * kSide, 0, 0.5f * kSide}, 0.9273f);
    const PictureOptions options = without_ground(100, 100, 1);
    const std::vector<std::uint8_t> readers =
        light_map_readers(bark.scene, constant_environment(glm::vec3(1.f)), camera, options);
    const double maps = light_map_bytes(bark.patches, readers, bark.scene.light_maps.maps[0].bands);
    EXPECT_EQ(light_map_bytes(bark.patches, std::vector<std::uint8_t>(bark.patches.patches.size(), 0), 7), 0);
    EXPECT_EQ(light_map_bytes(bark.patches, {}, 7), 0);
    const std::optional<double> with_maps = taken_by(bark, queries, camera, options);
    bark.scene.light_maps = {};
    const std::optional<double> by_rays = taken_by(bark, queries, camera, options);
    if (!with_maps || !by_rays)
        GTEST_SKIP() << "skipped: the system does not tell of peaks of memory";
    const double corners = (kSide + 1.) * (kSide + 1.);
    EXPECT_GT(*with_maps - *by_rays, 0.9 * 588 * corners) << "no maps were read";
    EXPECT_GT(maps, 0.95 * (*with_maps - *by_rays));
    EXPECT_LT(maps, 2 * (*with_maps - *by_rays)); // corners are estimated: 0.75 a triangle, where these have a half
    EXPECT_GT(*with_maps, 1.5 * *by_rays) << "what the test is to find is lost in the rest";
}

TEST(PictureMemory, OfGatheringGrowsWithWhatIsSeen) {
    constexpr std::uint32_t kPatches = 20000;
    for (const std::uint32_t seen : {100u, 3000u, 20000u}) {
        GatheredSums sums(2 * kPatches, 2 * kPatches);
        for (std::uint32_t k = 0; k < seen; ++k) {
            GatheredSample sample;
            sample.places.places.fill(k);
            sample.is_flat = true;
            sample.lobe = k;
            sums.add(sample);
        }
        const double most = GatheredSums::most_bytes({kPatches, 0, double(seen), 0});
        EXPECT_GT(most, double(sums.bytes()));
        EXPECT_LT(most, 2.1 * double(sums.bytes()));
    }
}

TEST(PictureMemory, OfLightHasCornersOfBark) {
    PatchScene leaves = field_of_leaves(10), bark = leaves;
    for (Patch& patch : bark.patches)
        patch.kind = PatchKind::bark;
    const PictureOptions options = small_picture(10, 10);
    EXPECT_GT(light_bytes(options, bark, 1), light_bytes(options, leaves, 1) + 200 * 0.75 * 24);
    PictureOptions gathering = options;
    gathering.gather_rays.reset();
    EXPECT_GT(light_bytes(gathering, leaves, 1), light_bytes(options, leaves, 1));
}

} // namespace
} // namespace kokage::test
