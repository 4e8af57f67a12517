#pragma once
#include "tests/unit/reflection/picture_scenes.h"

#include <cmath>

namespace kokage::test {

/// A ball of one patch with smooth normals.
struct Ball {
    PatchScene patches;
    ShadedScene scene;

    explicit Ball(const Optics& optics, const Gloss& gloss = {}, int rings = 48) {
        const int segments = 2 * rings;
        for (int r = 0; r <= rings; ++r)
            for (int s = 0; s < segments; ++s) {
                const float polar = kPi * float(r) / rings, azimuth = 2 * kPi * float(s) / segments;
                patches.positions.emplace_back(std::sin(polar) * std::cos(azimuth), std::cos(polar),
                                               -std::sin(polar) * std::sin(azimuth));
            }
        const auto at = [&](int r, int s) { return std::uint32_t(r * segments + s % segments); };
        for (int r = 0; r < rings; ++r)
            for (int s = 0; s < segments; ++s) {
                patches.triangles.emplace_back(at(r, s), at(r + 1, s), at(r + 1, s + 1));
                patches.triangles.emplace_back(at(r, s), at(r + 1, s + 1), at(r, s + 1));
            }
        patches.triangle_patch.assign(patches.triangles.size(), 0);
        patches.patches.push_back({0, std::uint32_t(patches.triangles.size()), 0, PatchKind::bark, 0});
        patches.optics = {optics};
        scene = evenly_shaded(patches, glm::vec3(0.f));
        scene.normals = patches.positions;
        SurfaceLook look;
        look.gloss = gloss;
        look.smooth_normals = true;
        scene.looks = {look};
        scene.triangle_look.assign(patches.triangles.size(), 0);
    }
    Ball(const Ball&) = delete;
};

} // namespace kokage::test
