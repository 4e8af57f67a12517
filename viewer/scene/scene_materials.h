#pragma once
// What the surfaces of a scene are made of: a tree's or object's own material, changed by what the scene file says.
#include "reflection/gloss.h"
#include "trees/tree.h"
#include "viewer/scene/scene_description.h"

#include <map>

namespace kokage {

/// What TreeMaterial does not tell of a surface. Roughness is TreeMaterial's.
struct Finish {
    std::shared_ptr<const Image> roughness_texture; ///< 1 channel
    std::optional<glm::dvec2> roughness_from_foot_to_top;
    float metallic = 0;
    float index_of_refraction = 1.5f;        ///< 1: matt
    std::optional<ReliefDescription> relief; ///< empty: the material's own
    std::string pointer;                     ///< where what changed it stands in the scene file, for messages
};

struct SceneSurface {
    TreeMaterial material;
    Finish finish;
};

/// Image files, each loaded once.
class TextureFiles {
  public:
    std::shared_ptr<const Image> color(const std::filesystem::path& file); ///< linear RGB
    /// 1 channel: the first, or the second of three (glTF's roughness).
    std::shared_ptr<const Image> roughness(const std::filesystem::path& file);
    std::size_t bytes() const { return bytes_; }

  private:
    std::map<std::filesystem::path, std::shared_ptr<const Image>> colors_, roughnesses_;
    std::size_t bytes_ = 0;
};

/// What `description` says takes the place of what the surface was. Throws InputError for files that can't be read.
SceneSurface changed_surface(SceneSurface surface, const MaterialDescription& description, TextureFiles& files);

/// Reflectance seen along the normal: ((n-1)/(n+1))² of what is no metal, a metal's base colour. `foot`, `top`: heights
/// of what wears it.
Gloss gloss_of(const SceneSurface& surface, const glm::vec3& mean_base_color, float foot, float top);

/// What a surface's diffuse part keeps of its optics: metals scatter nothing, and what mirrors does not scatter twice
/// (k of reflection/gloss.h).
glm::vec3 diffuse_share(const SceneSurface& surface, const Gloss& gloss);

} // namespace kokage
