// One map serves any number of a host's own threads at once, with the same bits as one thread gets.
#include "reflection/maps/filtered_map.h"
#include "reflection/maps/horizon.h"
#include "reflection/maps/prefiltered_cube.h"
#include "reflection/maps/shell_map.h"
#include "reflection/maps/voxel_cube.h"
#include "tests/support/cube_maps.h"
#include "tests/unit/common/scene_builders.h"

#include <atomic>
#include <gtest/gtest.h>
#include <thread>

namespace kokage {
namespace {

constexpr int kThreads = 6, kLookups = 4000;

struct Places {
    std::vector<glm::vec3> directions, normals;
    std::vector<float> exponents, roughnesses, smoothnesses;

    Places() {
        Random random(6);
        for (int i = 0; i < kLookups; ++i) {
            directions.push_back(test::random_direction(random));
            normals.push_back(test::random_direction(random));
            exponents.push_back(std::exp(random.uniform(0, 5)));
            roughnesses.push_back(random.uniform(0.05f, 1));
            smoothnesses.push_back(random.uniform());
        }
    }
};

std::vector<glm::vec3> some_texels(std::size_t count) {
    Random random(2);
    std::vector<glm::vec3> texels(count);
    for (glm::vec3& texel : texels)
        texel = {random.uniform(), random.uniform(), random.uniform(0, 1e4f)};
    return texels;
}

ShellMap some_shells(TexelFilter filter, TexelFormat format) {
    ShellMap map({.most_parameter = 150, .filter = filter, .format = format});
    map.set_texels(some_texels(map.layout().size()));
    return map;
}

/// `work` gives the same from one thread as from each of many that run it at the same time.
void expect_same_from_many_threads(const char* what, const std::function<std::vector<glm::vec3>()>& work) {
    const std::vector<glm::vec3> alone = work();
    std::vector<std::vector<glm::vec3>> results(kThreads);
    std::atomic<int> waiting = kThreads;
    std::vector<std::thread> threads;
    for (std::vector<glm::vec3>& result : results)
        threads.emplace_back([&] {
            --waiting;
            while (waiting > 0) // all begin together
                std::this_thread::yield();
            result = work();
        });
    for (std::thread& thread : threads)
        thread.join();
    for (const std::vector<glm::vec3>& result : results)
        EXPECT_TRUE(result == alone) << what;
}

TEST(MapsFromManyThreads, Shells) {
    const Places places;
    for (const auto& [filter, format] : {std::pair(TexelFilter::bilinear, TexelFormat::half_rgb),
                                         {TexelFilter::cubic, TexelFormat::float_rgb},
                                         {TexelFilter::cubic, TexelFormat::shared_exponent}}) {
        const ShellMap map = some_shells(filter, format);
        expect_same_from_many_threads("one by one", [&] {
            std::vector<glm::vec3> values;
            for (int i = 0; i < kLookups; ++i)
                values.push_back(map.lookup(places.directions[i], double(places.exponents[i])));
            return values;
        });
        expect_same_from_many_threads("all at once", [&] {
            std::vector<glm::vec3> values(kLookups);
            map.lookup(places.directions, places.exponents, values);
            return values;
        });
    }
}

TEST(MapsFromManyThreads, VoxelCube) {
    const Places places;
    VoxelCube cube(LobeKind::phong, RoughnessScale::solved(32));
    cube.set_texels(some_texels(cube.layout().size()));
    expect_same_from_many_threads("one by one", [&] {
        std::vector<glm::vec3> values;
        for (int i = 0; i < kLookups; ++i)
            values.push_back(cube.lookup(places.directions[i], cube.smoothness(double(places.exponents[i]))));
        return values;
    });
    expect_same_from_many_threads("all at once", [&] {
        std::vector<glm::vec3> values(kLookups);
        cube.lookup(places.directions, places.smoothnesses, values);
        return values;
    });
}

TEST(MapsFromManyThreads, HorizonAndItsTable) {
    const Places places;
    const ShellMap map = some_shells(TexelFilter::bilinear, TexelFormat::half_rgb);
    const HorizonTable shared(LobeKind::phong);
    expect_same_from_many_threads("one table for all", [&] {
        std::vector<glm::vec3> values;
        for (int i = 0; i < kLookups; ++i)
            values.push_back(filtered_above_horizon(
                shared, places.normals[i], places.directions[i], double(places.exponents[i]),
                [&](const glm::vec3& direction, double parameter) { return map.lookup(direction, parameter); }));
        return values;
    });
    expect_same_from_many_threads("each makes its own", [&] {
        const HorizonTable own(LobeKind::ggx, HorizonCorrection::one_lookup);
        std::vector<glm::vec3> values;
        for (int i = 0; i < 100; ++i) {
            const HorizonLookup at = own.lookup(places.normals[i], places.directions[i], double(places.roughnesses[i]));
            values.push_back(at.share * at.directions[0] + at.parameter);
        }
        return values;
    });
}

TEST(MapsFromManyThreads, CubeMapAndAnyMapAsAFunction) {
    const Places places;
    const PrefilteredCube cube = smooth_cube({.size = 16, .parameters = {0, 0.4, 1}});
    expect_same_from_many_threads("cube map", [&] {
        std::vector<glm::vec3> values;
        for (int i = 0; i < kLookups; ++i)
            values.push_back(cube_lookup(cube, places.directions[i], 2 * places.smoothnesses[i]));
        return values;
    });
    for (const FilteredMap& map :
         {filtered_map(cube), filtered_map(some_shells(TexelFilter::cubic, TexelFormat::half_rgb))})
        expect_same_from_many_threads("a function", [&] {
            std::vector<glm::vec3> values(kLookups);
            map.lookup(places.directions, map.least_parameter + 0.3, values);
            return values;
        });
}

} // namespace
} // namespace kokage
