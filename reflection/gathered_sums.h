#pragma once
// What rays gathered, summed up over what the camera sees, and what follows for a patch's light. Private to reflection.
#include "reflection/gather_prior.h"
#include "reflection/gloss_shading.h"
#include "reflection/lobe_prior.h"
#include "reflection/surface_shading.h"
#include "reflection/values_of_some.h"

#include <optional>

namespace kokage {

/// Light through a lobe: what one ray of it brought, and what light maps say of it all.
struct LobeOfMap {
    glm::vec3 ray{0.f}, map{0.f};
};

/// What one point that is seen says of its patch.
struct GatheredSample {
    LightPlaces places;
    glm::vec3 gathered{0.f}, solved{0.f}; ///< light that its ray brought, and that was solved
    std::uint32_t look = 0;               ///< 2 look + side, whose mean correction a patch of few rays takes
    bool is_flat = false;                 ///< its light may slope over the patch
    std::optional<std::uint32_t> lobe;    ///< GlossShading::lobe_of_patch
    glm::vec3 lobe_open{0.f}, lobe_correction{0.f};
    std::optional<LobeOfMap> lobe_of_map; ///< where light maps light the gloss
    glm::vec3 point{0.f}, origin{0.f};    ///< where the rays began, and one corner of its patch
};

class GatheredSums {
  public:
    /// Of so many places of light and lobes.
    GatheredSums(std::size_t places, std::size_t lobes);

    void add(const GatheredSample& sample);
    /// To be called when every pixel had one more ray.
    void end_pass();
    std::uint64_t samples() const { return samples_; }
    std::size_t bytes() const;
    /// `corners` are of smooth surfaces, `seen_...` those that samples had.
    struct Counts {
        double patches = 0, corners = 0, seen_patches = 0, seen_corners = 0;
    };
    /// The most that bytes() may be.
    static double most_bytes(const Counts& counts);
    /// The most that give_light takes beside, while it works.
    static double most_bytes_to_give(const Counts& counts);
    /// As it was at the end of the last pass, so that all of a patch is gathered or nothing.
    bool enough(const LightPlaces& places) const;

    void give_light(SurfaceShading& surfaces, const PatchScene& patches, const CameraFrame& frame) const;
    /// All but those of large patches.
    void give_lobes(GlossShading& gloss, const PatchScene& patches, const CameraFrame& frame) const;

  private:
    struct Place : PlaceSums {
        int passes = 0; ///< after which it had rays enough; 0: it hasn't
    };
    struct Lobe : GatheredLobe {
        bool is_large = false; ///< has enough rays after the first pass
    };

    std::uint32_t class_of(std::uint32_t place, const Place& sums, const PatchScene& patches,
                           const CameraFrame& frame) const;

    ValuesOfSome<Place> of_places_;
    ValuesOfSome<Lobe> of_lobes_;
    ValuesOfSome<PatchMoments> moments_of_places_, moments_of_lobes_;
    std::uint64_t samples_ = 0;
    int passes_ = 0;
};

} // namespace kokage
