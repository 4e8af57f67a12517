#pragma once
// The light that bounces in the crown, as a field between light-environment maps: captured from what patches send, read
// at any patch. Method `light-maps` iterates it; `bundles` takes its first guess from it.
#include "foliage/captured_maps.h"
#include "foliage/method.h"
#include "foliage/patch_geometry.h"

namespace kokage {

struct LightMapFieldOptions {
    int maps = 100;             ///< places to pick (fewer when the tree has fewer)
    int bands = 7;              ///< 1 to 40
    int least_directions = 968; ///< capture rays a map
    int nearest = 4;            ///< maps that a patch reads (measured: 3 to 6 alike, 8 and more worse)
    GatherRule gather = GatherRule::cosine;
    /// Per patch: whether it reads maps. Empty: all do. The others get no light from them, and maps that only they
    /// would read are not captured.
    std::vector<std::uint8_t> readers{};
};

/// Irradiance of both sides of every patch. The back of bark is inside the wood: 0.
struct SideIrradiance {
    std::vector<glm::vec3> front, back;
};

/// Built once per scene (placement, capture and weights; no light in it). Then, as often as wanted:
///     field.update(radiance, ground);   // captures the maps under this radiance
///     field.irradiance()                // what they send to the patches
/// Reading is linear in the radiance, never negative, and never above pi x the largest radiance: maps are windowed by a
/// non-negative kernel of unit mass, captured by a quadrature that is exact for it, and mixed with convex weights. So a
/// bounce shrinks any difference by max(rho + tau) or more.
class LightMapField {
  public:
    /// `queries` must outlive it. Throws InputError for options out of range.
    LightMapField(const RayQueries& queries, const GroundCells& ground, const Tree& tree,
                  const LightMapFieldOptions& options, Progress& progress);

    /// Radiance of patches and of ground cells (as long as the grid, or empty: dark) as the maps will see it. Sky and
    /// lights are not in it.
    void update(const SideRadiance& radiance, std::span<const glm::vec3> ground);
    SideIrradiance irradiance() const;

    /// Tells the field which share of each side's cosine-weighted hemisphere other patches really fill (bundles and
    /// rays know it per side; maps know it only where they stand). From then on
    ///     irradiance() = pi x sqrt(that share x the share that the maps see filled) x mean radiance of what the maps
    ///     see there,
    /// which keeps the class's promises, as both shares are at most 1. The geometric mean is measured: the side's own
    /// share alone makes deep leaves too bright, the maps' alone makes outer leaves too bright (README). Forgets the
    /// last update().
    void set_filled_shares(const std::vector<float>& front, const std::vector<float>& back);

    using Reading = LightMapShare;
    /// A patch's shares add up to 1, or it reads no map at all.
    std::span<const Reading> readings(std::size_t patch) const {
        return {readings_.data() + patch * per_patch_, per_patch_};
    }

    const CapturedMaps& maps() const { return *maps_; }
    const LightMapPlacement& placement() const { return placement_; } ///< all that were picked
    std::size_t unread_maps() const { return unread_; } ///< of them, never captured because no patch reads them
    /// Maps for hosts: `sky` (cell means, or empty) as seen past the tree, and what patches and ground sent at the last
    /// update(); windowed.
    std::vector<LightMap> export_maps(std::span<const glm::vec3> sky) const;
    /// The same, with the patches' readings.
    LightMapsOfPatches export_for_patches(std::span<const glm::vec3> sky) const {
        return {export_maps(sky), per_patch_, readings_};
    }
    std::size_t bytes() const;

  private:
    bool reads(std::size_t patch) const { return options_.readers.empty() || options_.readers[patch] != 0; }
    void choose_nearest(int nearest);
    void drop_unread();
    void weigh();
    float visible_share(std::size_t map, const glm::vec3& point) const;
    void average_curved();
    std::pair<glm::vec3, glm::vec3> read_cosine(std::size_t patch, std::vector<float>& harmonics) const;
    SideIrradiance read() const;
    glm::vec3 read_rule(std::size_t patch, std::vector<float>& harmonics) const;

    LightMapFieldOptions options_;
    PatchGeometry geometry_;
    LightMapPlacement placement_;
    std::vector<LightMapPlace> places_; ///< those that are read
    std::size_t unread_ = 0;
    std::size_t per_patch_ = 0;
    std::vector<Reading> readings_;
    std::unique_ptr<CapturedMaps> maps_;
    std::vector<double> window_;
    MapCoefficients captured_;          ///< as of the last update()
    MapCoefficients coefficients_;      ///< windowed; for the cosine rule convolved with it as well
    std::vector<std::int32_t> curved_;  ///< per patch: its place in mean_harmonics_, -1 where one normal will do
    std::vector<float> mean_harmonics_; ///< of curved patches: harmonics averaged over the normals of their area
    std::vector<float> front_scale_, back_scale_; ///< from filled shares; empty without
    const PatchScene& scene_;
};

} // namespace kokage
