#include "trees/stand_in_colors.h"

#include "common/services/named_file.h"

#include <map>

namespace kokage {
namespace {

// Reflectances of broad leaves and of brown bark, rounded (as the benchmark's realistic materials).
constexpr glm::vec3 kLeaf(0.10f, 0.25f, 0.06f), kBark(0.15f, 0.10f, 0.07f);

bool needs_color(const SceneMaterial& material, const SceneMesh& mesh) {
    return material.color_is_lost || (material.is_missing && mesh.colors.empty());
}

} // namespace

std::vector<std::string> stand_in_for_lost_colors(MeshScene& scene, const std::vector<TreePartKind>& kinds) {
    std::map<std::pair<int, TreePartKind>, int> colored; // material and kind -> the material in its place
    std::vector<std::string> notes;
    for (std::size_t m = 0; m < scene.meshes.size() && m < kinds.size(); ++m) {
        SceneMesh& mesh = scene.meshes[m];
        const SceneMaterial& source = scene.materials[std::size_t(mesh.material)];
        if (!needs_color(source, mesh))
            continue;
        const bool is_leaf = kinds[m] == TreePartKind::foliage;
        const auto [place, is_new] = colored.try_emplace({mesh.material, kinds[m]}, int(scene.materials.size()));
        if (is_new) {
            SceneMaterial material = source;
            material.base_color =
                glm::vec4(glm::vec3(material.base_color) * (is_leaf ? kLeaf : kBark), material.base_color.a);
            material.color_is_lost = false;
            if (material.is_missing)
                notes.push_back(is_leaf ? "leaves without a material (mesh '" + shown_name(mesh.name) +
                                              "') take an average leaf's: they reflect 0.10, 0.25, 0.06 and let 0.8 of "
                                              "that through"
                                        : "bark without a material (mesh '" + shown_name(mesh.name) +
                                              "') takes average bark's: it reflects 0.15, 0.10, 0.07");
            scene.materials.push_back(std::move(material));
        }
        mesh.material = place->second;
    }
    return notes;
}

} // namespace kokage
