#pragma once
// Trees to write and read in tests.
#include "common/services/random.h"
#include "trees/growth.h"
#include "trees/write_tree.h"

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

namespace kokage {

/// The folder of real data, if this machine has it.
inline std::optional<std::filesystem::path> data_folder() {
    const char* folder = std::getenv("KOKAGE_DATA");
    return folder && *folder ? std::optional<std::filesystem::path>(folder) : std::nullopt;
}

inline Tree small_oak(int leaves = 400) {
    GrowthParameters parameters = oak_parameters();
    parameters.leaves = leaves;
    return grow(parameters);
}

/// Light that differs in every entry, 0 to 20 and a few far above.
inline ShadedAttributes random_light(const Tree& tree, std::uint64_t seed = 1) {
    Random random(seed);
    ShadedAttributes light;
    const std::size_t patches = tree.leaves.size() + tree.bark_patch_count;
    const auto color = [&] {
        return glm::vec3(random.uniform(), random.uniform(), random.uniform()) * (random.below(50) == 0 ? 500.f : 20.f);
    };
    for (std::size_t i = 0; i < patches; ++i) {
        light.radiance_front.push_back(color());
        light.radiance_back.push_back(color());
        light.indirect_front.push_back(color());
        light.indirect_back.push_back(color());
    }
    for (int i = 0; i < 3; ++i) {
        LightMap map;
        map.position = color();
        map.radius_m = random.uniform();
        map.generation = i;
        map.bands = 3 + i;
        for (int c = 0; c < map.bands * map.bands; ++c)
            map.coefficients.push_back(color());
        light.light_maps.push_back(map);
    }
    return light;
}

} // namespace kokage
