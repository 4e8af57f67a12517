#include "viewer/scene/shaded_scene.h"

namespace kokage {

SurfaceLook look_of(const Tree& tree, const TreePart& part, const glm::vec3& mean) {
    const TreeMaterial& material = tree.materials[part.material];
    SurfaceLook look;
    look.base_color = material.base_color;
    look.base_color_texture = part.uvs.empty() ? nullptr : material.base_color_texture;
    look.mean_base_color = mean;
    look.wrap_u = material.wrap_u;
    look.wrap_v = material.wrap_v;
    look.smooth_normals = part.kind == TreePartKind::bark;
    return look;
}

ShadedScene shaded_scene(const Tree& tree, const PatchScene& patches, const PatchOrigins& origins,
                         const Solution& solution) {
    ShadedScene scene;
    scene.patches = &patches;
    scene.normals = origins.normals;
    for (const TreePart& part : tree.parts)
        scene.looks.push_back(look_of(tree, part, mean_base_color(tree, part.material, part.kind)));
    scene.triangle_look = origins.triangle_part;
    scene.indirect_front = solution.indirect.front;
    scene.indirect_back = solution.indirect.back;
    scene.radiance_front = solution.radiance.front;
    scene.radiance_back = solution.radiance.back;
    return scene;
}

} // namespace kokage
