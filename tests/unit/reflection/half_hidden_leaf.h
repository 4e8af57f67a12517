#pragma once
// A leaf whose seen half has other light than the leaf in the mean.
#include "reflection/path_traced_picture.h"
#include "tests/unit/reflection/picture_scenes.h"

namespace kokage::test {

/// A leaf whose left half lies close under a black one. A camera above sees
/// its right half alone, and that is in the open but for what the black one hides at its side.
struct HalfHiddenLeaf {
    PatchScene patches;
    ShadedScene scene;
    Environment sky = constant_environment(glm::vec3(1, 2, 3));
    Camera camera = camera_at({0.5f, 6, 0}, {0.5f, 0, 0}, 0.12f);

    explicit HalfHiddenLeaf(const Gloss& gloss = {}) {
        patches.optics = {{glm::vec3(0.4f), glm::vec3(0.f)}, {glm::vec3(0.f), glm::vec3(0.f)}};
        add_rectangle(patches, {-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, 0);
        add_rectangle(patches, {-1, 0.1f, 1}, {1, 0, 0}, {0, 0, -2}, 1);
        scene = evenly_shaded(patches, glm::vec3(0.f));
        // In the mean over the leaf: half of it is as good as black.
        scene.indirect_front[0] = scene.radiance_front[0] = 0.2f * glm::vec3(1, 2, 3);
        scene.looks.resize(1);
        scene.looks[0].gloss = gloss;
        scene.triangle_look.assign(patches.triangles.size(), 0);
    }

    Picture solved(int gather_rays, const PictureOptions& base = without_ground(32, 32, 8)) const {
        PictureOptions options = base;
        options.gather_rays = gather_rays;
        return render_picture(scene, RayQueries(patches), sky, camera, options, silent_progress());
    }
    Image traced(int samples) const {
        return render_path_traced(scene, RayQueries(patches), sky, camera, without_ground(32, 32, samples),
                                  silent_progress())
            .radiance;
    }
};

} // namespace kokage::test
