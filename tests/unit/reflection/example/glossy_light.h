// How a program uses reflection maps: bake once, then look up by roughness, with the horizon. reflection/README.md
// shows this file.
#include "common/environment/load_environment.h"
#include "reflection/maps/horizon.h"
#include "reflection/maps/make_baker.h"
#include "reflection/maps/shell_map.h"

class GlossyLight {
  public:
    /// From a lat-long image (.hdr, .exr, .png), for glTF's roughness from 0.1 to 1.
    explicit GlossyLight(const std::filesystem::path& image)
        : map_({.kind = kokage::LobeKind::ggx, .least_parameter = 0.1, .most_parameter = 1}),
          horizon_(kokage::LobeKind::ggx) {
        kokage::EnvironmentReport repaired;
        const kokage::Environment around = kokage::load_environment(image, repaired, {.split = false});
        kokage::WorkReport work; // what was done, and how long it took
        const auto baker = kokage::make_baker(map_.layout(), around.remainder.width, around.remainder.height, {}, work);
        std::vector<glm::vec3> filtered(map_.layout().size());
        baker->bake(around, filtered, work);
        map_.set_texels(filtered);
    }

    /// Mean radiance that the surface mirrors towards the viewer; from any thread. Unit vectors, +Y up.
    glm::vec3 reflected(const glm::vec3& normal, const glm::vec3& to_viewer, float roughness) const {
        const glm::vec3 mirrored = 2 * glm::dot(normal, to_viewer) * normal - to_viewer;
        return kokage::filtered_above_horizon(
            horizon_, normal, mirrored, double(roughness),
            [&](const glm::vec3& direction, double parameter) { return map_.lookup(direction, parameter); });
    }

  private:
    kokage::ShellMap map_;
    kokage::HorizonTable horizon_;
};
