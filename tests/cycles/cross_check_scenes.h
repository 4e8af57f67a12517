#pragma once
// The scenes of the cross-check with Cycles: trees as `kokage` shades and draws them, all of it matt.
#include "common/environment/environment.h"
#include "reflection/picture.h"
#include "trees/patches.h"
#include "trees/tree.h"

#include <filesystem>
#include <string>
#include <vector>

namespace kokage {

struct CrossCheckScene {
    std::string name, description;
    PatchScene patches;
    std::vector<glm::vec3> normals;
    std::vector<SurfaceLook> looks;
    std::vector<std::uint32_t> triangle_look;
    Environment environment;
    Camera camera;

    /// Without solved light, which path tracing doesn't read. Refers to the scene.
    ShadedScene shaded() const;
};

/// A maple with 200 leaves on a pale ground, sun and a gradient: small enough for the test suite.
CrossCheckScene small_scene();
/// An oak of 4000 leaves under a constant sky, no ground, bright leaves: light of many bounces.
CrossCheckScene oak_in_the_open();
/// A maple with smooth bark on an endless ground, seen from below: a disc sun, a gradient.
CrossCheckScene under_a_maple();
/// A tree file with alpha-masked cards and textures beside a smooth matt teapot on a square of ground, lit by an HDR
/// photograph whose lights were split off. Needs the data folder's files: throws InputError naming what isn't there.
CrossCheckScene cards_and_teapot(const std::filesystem::path& data);

} // namespace kokage
