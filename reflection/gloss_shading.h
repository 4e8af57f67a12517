#pragma once
// What a surface's gloss shows a camera, split-off lights apart: surroundings through its lobe, and the scene where it
// stands in front of them.
#include "reflection/glossy_light.h"
#include "reflection/incoming_radiance.h"
#include "reflection/light_map_gloss.h"
#include "reflection/surface_shading.h"
#include "reflection/values_of_some.h"

#include <optional>

namespace kokage {

/// The lobe is looked up in a multi-scale map as if nothing stood in the way; one ray drawn from the lobe for every
/// camera ray corrects it: where it meets the scene, what it meets replaces the surroundings behind it. So the map
/// carries what varies little, rays only the difference, and without anything in the way there is no noise. Rough bark
/// with light maps about it takes all from them (light_map_gloss.h).
class GlossShading {
  public:
    /// Bakes `lobes` (gloss_in_view.h; empty: all that is in view is matt), and says in the report what that was. All
    /// must outlive it.
    GlossShading(const ShadedScene& scene, const Environment& environment, const SurfaceShading& surfaces,
                 const IncomingRadiance& incoming, const std::optional<RoughnessBounds>& lobes, Progress& progress,
                 WorkReport& report);

    /// K times the light through the lobe. `beside`: what else of the point is seen. A single ray's answer may be
    /// negative; their mean is not.
    glm::vec3 radiance(const SurfacePoint& at, const glm::vec3& direction, const glm::vec3& beside, SampleIndex sample,
                       ShadingScratch& scratch) const;

    /// Light through the lobe about the mirrored `direction`, of the surroundings as if nothing stood in the way.
    glm::vec3 open_light(const SurfacePoint& at, const glm::vec3& direction) const;
    /// What one ray of the lobe, drawn by two uniform numbers, finds to change in it.
    glm::vec3 correction(const SurfacePoint& at, const glm::vec3& direction, const glm::vec2& numbers,
                         SampleIndex sample, ShadingScratch& scratch) const;

    /// A flat patch (flat_patches.h) of one, not too small roughness sees nearly the same in its lobe all over: which
    /// of lobe_count() it has. Empty: it is smooth, uneven or not glossy.
    std::optional<std::uint32_t> lobe_of_patch(const SurfacePoint& at) const;
    std::size_t lobe_count() const { return of_patches_.places(); }
    /// Is taken from now on for all points of this side of the patch.
    void set_light_of_patch(std::uint32_t lobe, const glm::vec3& light, const PatchGradient& gradient) {
        of_patches_.at(lobe) = {light, gradient};
    }
    /// Bytes of such light, where so many patches have it.
    static double most_lobe_bytes(double patches, double known) {
        return ValuesOfSome<LobeLight>::most_bytes(2 * patches, known);
    }

    /// True where light maps give it all (light_map_gloss.h).
    bool has_maps(const SurfacePoint& at) const { return from_maps_ && from_maps_->lights(at); }
    /// What they give, where they do.
    glm::vec3 light_of_maps(const SurfacePoint& at, const glm::vec3& direction) const;
    /// What one ray of the lobe, drawn by two uniform numbers, finds of the same.
    glm::vec3 light_of_ray(const SurfacePoint& at, const glm::vec3& direction, const glm::vec2& numbers,
                           SampleIndex sample, ShadingScratch& scratch) const;
    /// Of a place of light (LightPlaces), from now on.
    void scale_maps(std::uint32_t place, const glm::vec3& factor) { from_maps_->scale(place, factor); }

  private:
    std::optional<glm::vec3> met(const SurfacePoint& at, const glm::vec3& direction, SampleIndex sample,
                                 ShadingScratch& scratch) const;
    static glm::vec3 mirrored(const SurfacePoint& at, const glm::vec3& direction);
    static float chance_of_ray(const glm::vec3& open, const glm::vec3& beside);

    const ShadedScene& scene_;
    const Environment& environment_;
    const SurfaceShading& surfaces_;
    const IncomingRadiance& incoming_;
    std::optional<GlossyRemainder> remainder_; ///< empty: no gloss is drawn by itself
    std::optional<LightMapGloss> from_maps_;
    std::vector<bool> even_; ///< looks whose patches may share one lobe's light
    struct LobeLight {
        glm::vec3 mean{0.f};
        PatchGradient gradient;
    };
    ValuesOfSome<LobeLight> of_patches_; ///< front and back of each patch; no places: none shares it
};

} // namespace kokage
