#pragma once
// The split-off lights of an environment as the sides receive them. A light is drawn once and kept until it moves.
#include "common/services/progress.h"
#include "common/services/work_report.h"
#include "foliage/bundles/effort.h"
#include "foliage/bundles/light_beams.h"
#include "foliage/bundles/point_beams.h"
#include "foliage/bundles/ray_lights.h"

#include <memory>

namespace kokage::bundles {

/// Irradiance from lights, unscattered: each half holds all of it.
struct BeamLight {
    std::vector<Rgb> halves[2];    ///< per side
    std::vector<glm::vec3> ground; ///< per texel, in the tree's shadow
    glm::vec3 open_ground{0.f};    ///< of ground that lies open (distant lights only)
    glm::vec3 mean(Side side) const { return 0.5f * (halves[0][side].vec() + halves[1][side].vec()); }
};

class DrawnLights {
  public:
    /// References must outlive it.
    DrawnLights(const PatchScene& scene, const Facets& facets, const std::optional<GroundGrid>& ground);
    /// Has the leaves that are too small for beams lit by rays from now on (null: none); it must outlive this.
    void set_ray_lights(RayLights* ray_lights) { ray_lights_ = ray_lights; }
    /// Draws the lights that are new, forgets those that are gone, and adds all up.
    BeamLight light(const Environment& environment, const BundleEffort& effort, double negligible, std::uint64_t seed,
                    Progress& progress, WorkReport& report);
    /// Forgets all lights (when the effort changes).
    void clear();
    std::size_t bytes() const;

  private:
    struct Distant {
        DistantLight light;
        std::vector<Beam> beams; ///< of a light of irradiance `light.irradiance`
        BeamVisibility visibility;
        std::vector<glm::vec2> mean_open; ///< per beam: of leaves and of bark, 0 ... 254
        float samples = 0;                ///< pixels a leaf, over all beams
    };
    const Distant& draw(const DistantLight& light, const LightEffort& effort, std::vector<Distant>& kept,
                        std::uint64_t seed);
    void add(const Distant& drawn, const glm::vec3& scale, BeamLight& sum) const;
    void add(const PointTransfer& transfer, const glm::vec3& intensity, BeamLight& sum) const;
    void light_points(const Environment& environment, const BundleEffort& effort, std::uint64_t seed, BeamLight& sum,
                      WorkReport& report);

    const PatchScene& scene_;
    const Facets& facets_;
    const std::optional<GroundGrid>& ground_;
    std::vector<Distant> distant_;
    std::vector<PointTransfer> points_;
    std::unique_ptr<RayQueries> queries_; ///< built for the first point light
    RayLights* ray_lights_ = nullptr;
    std::size_t drawn_beams_ = 0;
};

} // namespace kokage::bundles
