#pragma once
// A trunk with relief under a sky, its light solved (it is convex, so exactly), and the same relief as a fine mesh.
#include "common/environment/lat_long.h"
#include "tests/unit/reflection/picture_scenes.h"
#include "tests/unit/reflection/relief_surfaces.h"

#include <memory>

namespace kokage::test {

/// Blue above, a dim ground's light below, and a low sun (irradiance `sun`; 0: none).
inline Environment sky_over_dim_ground(float sun) {
    Environment environment;
    environment.remainder = Image(32, 16, 3);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 32; ++x)
            for (int c = 0; c < 3; ++c)
                environment.remainder.at(x, y)[c] =
                    y < 8 ? 0.4f + 0.2f * float(c) + 0.04f * float(8 - y) : 0.14f - 0.02f * float(c);
    if (sun > 0)
        environment.distant_lights.push_back(
            disc_light({0.8f, 0.35f, 0.6f}, 0.005f, sun * glm::vec3(1.f, 0.9f, 0.75f)));
    return environment;
}

inline glm::dvec3 remainder_irradiance(const Environment& environment, const glm::vec3& normal) {
    const Image& image = environment.remainder;
    glm::dvec3 sum(0.);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const double cosine = glm::dot(pixel_direction(x, y, image.width, image.height), glm::dvec3(normal));
            for (int c = 0; c < 3; ++c)
                sum[std::size_t(c)] +=
                    std::max(0., cosine) * double(image.at(x, y)[c]) * pixel_solid_angle(y, image.width, image.height);
        }
    return sum;
}

struct BarkTube {
    SurfaceArrays arrays;
    PatchScene patches;
    ShadedScene scene;
    ReliefDepth depth;
    std::shared_ptr<HeightField> field = std::make_shared<HeightField>(ridged_field(128, 128));

    BarkTube(const TubeShape& shape, const Environment& environment, float depth_m, float albedo = 0.3f)
        : arrays(make_tube(shape)), depth{depth_m, 0, 0.25f} {
        patches = scene_of(arrays.positions, arrays.triangles);
        patches.uvs = arrays.uvs;
        patches.optics = {{glm::vec3(albedo, 0.8f * albedo, 0.6f * albedo), glm::vec3(0.f)}};
        patches.leaf_count = 0;
        patches.patches.clear();
        for (std::uint32_t t = 0; t < patches.triangles.size(); t += 2) {
            patches.patches.push_back({t, 2, 0, PatchKind::bark, 0});
            patches.triangle_patch[t] = patches.triangle_patch[t + 1] = t / 2;
        }
        scene.patches = &patches;
        scene.normals = arrays.normals;
        scene.triangle_look.assign(patches.triangles.size(), 0);
        SurfaceLook look;
        look.mean_base_color = look.base_color = patches.optics[0].reflectance;
        look.smooth_normals = true;
        look.relief = {field, depth_m, 0};
        scene.looks = {look};
        for (const Patch& patch : patches.patches) {
            const glm::uvec3 a = patches.triangles[patch.first_triangle];
            const glm::vec3 normal = glm::normalize(arrays.normals[a.x] + arrays.normals[a.z]);
            const glm::vec3 scattered = patches.optics[0].reflectance / kPi,
                            indirect = scattered * glm::vec3(remainder_irradiance(environment, normal));
            glm::vec3 direct(0.f);
            for (const DistantLight& light : environment.distant_lights)
                direct += scattered * light.irradiance * std::max(0.f, glm::dot(light.direction, normal));
            scene.indirect_front.push_back(indirect);
            scene.radiance_front.push_back(indirect + direct);
        }
        scene.indirect_back.assign(patches.patches.size(), glm::vec3(0.f));
        scene.radiance_back = scene.indirect_back;
    }
    BarkTube(const BarkTube&) = delete;

    /// The slow twin.
    PatchScene displaced(int cuts) const {
        PatchScene mesh = displaced_scene(make_relief_shell(arrays.mesh(), depth, "tube"), *field, cuts);
        mesh.optics = patches.optics;
        return mesh;
    }
};

} // namespace kokage::test
