#include "trees/stand_in_colors.h"

namespace kokage {

void stand_in_for_lost_colors(MeshScene& scene, const std::vector<TreePartKind>& kinds) {
    // Reflectances of broad leaves and of brown bark, rounded (as the benchmark's realistic materials).
    const glm::vec3 leaf(0.10f, 0.25f, 0.06f), bark(0.15f, 0.10f, 0.07f);
    for (std::size_t m = 0; m < scene.meshes.size() && m < kinds.size(); ++m) {
        SceneMaterial& material = scene.materials[std::size_t(scene.meshes[m].material)];
        if (!material.color_is_lost)
            continue;
        const glm::vec3 color = kinds[m] == TreePartKind::foliage ? leaf : bark;
        material.base_color = glm::vec4(glm::vec3(material.base_color) * color, material.base_color.a);
        material.color_is_lost = false;
    }
}

} // namespace kokage
