#pragma once
// Rough gloss of bark, lit by the light maps of its place in the crown [F]: all that arrives there, sky and leaves,
// through the lobe above the surface's horizon, without a ray. Private to reflection.
#include "reflection/maps/horizon.h"
#include "reflection/surface_shading.h"

namespace kokage {

/// From this roughness on, maps of a few places, set right by gathered rays, tell more of a lobe than the rays of a
/// usual picture (README).
inline constexpr float kLeastMapRoughness = 0.7f;
/// The least roughness that maps are read for in this environment; above 1: none. Lobes narrower than a split-off light
/// find it by rays (is_wide_for), and maps have no such lights.
float least_map_roughness(const Environment& environment);
/// With so many camera rays a pixel, their own rays are nearer to the truth than maps.
inline constexpr int kTooManySamplesForMaps = 128;

/// Mixes of maps are blended from corner to corner of smooth surfaces, as solved light is. Thread-safe.
class LightMapGloss {
  public:
    /// Reads scene.light_maps. Throws InputError if their sizes disagree.
    LightMapGloss(const ShadedScene& scene, const Environment& environment, const SurfaceShading& surfaces);

    bool empty() const { return values_.empty(); }
    /// True where the place has maps, and the lobe is wide enough for them.
    bool lights(const SurfacePoint& at) const;
    /// What arrives through the lobe about `mirrored` (unit), above the horizon of at.normal. Only where it lights().
    glm::vec3 radiance(const SurfacePoint& at, const glm::vec3& mirrored) const;

    /// What is read at a place is multiplied from now on.
    void scale(std::uint32_t place, const glm::vec3& factor) {
        if (place < slot_.size() && slot_[place] != 0)
            factors_[slot_[place] - 1] = factor;
    }

    std::size_t bytes() const;
    /// Of so many places of light on one side (patches and corners), so many of which read maps of so many bands: at
    /// the most, while it is made.
    static double most_bytes(double places, double slots, int bands);

  private:
    /// `visit` takes the triangle's point and its places.
    template <typename Visit>
    void for_each_triangle_that_reads(Visit&& visit) const;
    void number_slots();
    void mix_at_corners();
    void fill_lobes();
    void fall_off(float roughness, std::span<float> of_bands) const;

    const ShadedScene& scene_;
    const SurfaceShading& surfaces_;
    float least_roughness_ = 2;
    std::size_t count_ = 0;           ///< coefficients a channel
    std::vector<std::uint32_t> slot_; ///< per place of light (LightPlaces): number in values_, from 1; 0: none
    std::vector<float> values_;       ///< of each slot: red, green and blue coefficients
    std::vector<glm::vec3> factors_;  ///< of each slot
    std::vector<float> lobes_;        ///< zonal coefficients by roughness, even steps from 0 to 1
    HorizonTable horizon_{LobeKind::ggx, HorizonCorrection::one_lookup};
};

} // namespace kokage
