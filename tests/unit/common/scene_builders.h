#pragma once
// Small scenes with known answers, shared by the tests of tracing and shading.
#include "common/environment/analytic_sky.h"
#include "common/environment/environment.h"
#include "common/scene/patch_scene.h"
#include "common/services/random.h"

#include <memory>
#include <vector>

namespace kokage::test {

/// Adds a patch of the given triangles (corner positions, three each) that is a leaf of its own.
inline void add_leaf(PatchScene& scene, const std::vector<glm::vec3>& corners, std::uint32_t optics = 0) {
    Patch patch;
    patch.first_triangle = std::uint32_t(scene.triangles.size());
    patch.triangle_count = std::uint32_t(corners.size() / 3);
    patch.optics = optics;
    patch.leaf = scene.leaf_count++;
    for (std::size_t i = 0; i < corners.size(); i += 3) {
        const auto first = std::uint32_t(scene.positions.size());
        scene.positions.insert(scene.positions.end(), {corners[i], corners[i + 1], corners[i + 2]});
        scene.triangles.emplace_back(first, first + 1, first + 2);
        scene.triangle_patch.push_back(std::uint32_t(scene.patches.size()));
    }
    scene.patches.push_back(patch);
}

/// A rectangle from `corner` along `u` and `v`; its front is the side of cross(u, v).
inline void add_rectangle(PatchScene& scene, const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v,
                          std::uint32_t optics = 0) {
    add_leaf(scene, {corner, corner + u, corner + u + v, corner, corner + u + v, corner + v}, optics);
}

inline glm::vec3 random_direction(Random& random) {
    const float y = random.uniform(-1, 1), azimuth = random.uniform(0, 2 * kPi),
                r = std::sqrt(std::max(0.f, 1 - y * y));
    return {r * std::cos(azimuth), y, r * std::sin(azimuth)};
}

/// Square leaves of one size, turned at random, uniform in a ball of radius 1 around (0, 2, 0).
/// Their total area is `area_index` times the ball's ground projection.
inline PatchScene random_crown(std::uint32_t leaves, float area_index, const Optics& optics, std::uint64_t seed = 1) {
    PatchScene scene;
    scene.optics = {optics};
    Random random(seed);
    const float size = std::sqrt(area_index * kPi / float(leaves));
    for (std::uint32_t i = 0; i < leaves; ++i) {
        glm::vec3 place;
        do
            place = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
        while (glm::dot(place, place) > 1);
        const glm::vec3 u = random_direction(random), v = glm::normalize(glm::cross(u, random_direction(random)));
        add_rectangle(scene, place + glm::vec3(0, 2, 0) - 0.5f * size * (u + v), size * u, size * v);
    }
    return scene;
}

/// A mask whose left half (u < 0.5) is solid.
inline AlphaMask half_mask() {
    Image alpha(2, 2, 1);
    alpha.pixels = {1, 0, 1, 0};
    AlphaMask mask;
    mask.alpha = std::make_shared<const Image>(alpha);
    return mask;
}

/// A mask with the texels of a checkerboard solid.
inline AlphaMask checkered_mask(int size) {
    Image alpha(size, size, 1);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
            *alpha.at(x, y) = float((x + y) % 2);
    AlphaMask mask;
    mask.alpha = std::make_shared<const Image>(alpha);
    return mask;
}

/// Puts the mask on every triangle; rectangles of add_rectangle get the unit square as texture coordinates.
inline void mask_rectangles(PatchScene& scene, const AlphaMask& mask) {
    scene.masks = {mask};
    scene.triangle_mask.assign(scene.triangles.size(), 0);
    scene.uvs.clear();
    for (std::size_t i = 0; i < scene.positions.size(); i += 6)
        scene.uvs.insert(scene.uvs.end(), {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}});
}

} // namespace kokage::test
