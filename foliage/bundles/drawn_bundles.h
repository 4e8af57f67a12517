#pragma once
// The line bundles of a scene with all that goes with them: facets, rays of the leaves that are too small for lines,
// and the lights as they were drawn. `bundles` bounces light along them; `light-maps` takes its first light from them.
#include "foliage/bundles/drawn_lights.h"

#include <memory>
#include <vector>

namespace kokage::bundles {

class DrawnBundles {
  public:
    /// `scene` must outlive it.
    explicit DrawnBundles(const PatchScene& scene);
    DrawnBundles(const DrawnBundles&) = delete; // lights refer to the rest
    DrawnBundles& operator=(const DrawnBundles&) = delete;

    /// Draws the lines, anew if there are some. Leaves `too_small` (leaves_too_small_for_lines()) and wide patches get
    /// rays. Lights are forgotten. Stages go to `report`. Throws Stopped; the lines that were there then serve on.
    void draw(const BundleEffort& effort, const std::vector<std::uint32_t>& too_small, Progress& progress,
              WorkReport& report);
    /// DrawnLights::light() with the effort of the last draw().
    BeamLight light(const Environment& environment, double negligible, std::uint64_t seed, Progress& progress,
                    WorkReport& report) {
        return lights_.light(environment, effort_, negligible, seed, progress, report);
    }

    const Facets& facets() const { return facets_; }
    const BundleTransport& transport() const { return transport_; }
    const BundleEffort& effort() const { return effort_; }
    /// Adds lines, fragments and rays.
    void count(WorkReport& report) const;
    std::size_t bytes() const;

  private:
    struct Rays { ///< for patches that are too small or too wide for lines
        explicit Rays(const PatchScene& scene) : queries(scene), points(scene) {}
        RayQueries queries;
        PatchPoints points;
    };
    const PatchScene& scene_;
    BundleEffort effort_;
    Facets facets_;
    BundleTransport transport_;
    std::unique_ptr<Rays> rays_;
    std::unique_ptr<RayLights> ray_lights_;
    DrawnLights lights_;
};

} // namespace kokage::bundles
