#pragma once
// Loads what GltfText builds, as a program would.
#include "common/gltf/gltf_scene.h"
#include "tests/support/gltf_text.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

namespace kokage::test {

inline MeshScene load(const GltfText& file) {
    TemporaryFolder folder;
    file.write(folder / "scene.gltf");
    return flatten(GltfDocument::read(folder / "scene.gltf"));
}

inline void expect_near(const glm::vec3& a, const glm::vec3& b, float tolerance = 1e-6f) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

} // namespace kokage::test
