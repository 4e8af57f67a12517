#pragma once
// Path-traced irradiance of both sides of every patch, in two independent halves, that can be continued.
#include "common/services/progress.h"
#include "common/trace/path_tracer.h"
#include "foliage/patch_points.h"
#include "foliage/solution.h"

#include <vector>

namespace kokage {

/// Sums over the paths of one side of a patch.
struct SideSums {
    glm::dvec3 half[2] = {glm::dvec3(0), glm::dvec3(0)}; ///< all light, of either half of the paths
    glm::dvec3 from_lights{0}, from_patches{0}; ///< unscattered light of split-off lights; light from other patches
    glm::dvec3 open_direction{0};               ///< cosine-weighted mean of directions that see the sky, times count
    double sees_sky = 0, sees_ground = 0;       ///< cosine-weighted shares of the hemisphere, times count
    std::uint32_t count[2] = {0, 0};

    glm::dvec3 half_irradiance(int h) const { return count[h] > 0 ? half[h] / double(count[h]) : glm::dvec3(0); }
    glm::dvec3 irradiance() const { return 0.5 * (half_irradiance(0) + half_irradiance(1)); }
    double paths() const { return std::max(1.0, double(count[0]) + double(count[1])); }
};

/// The halves use different seeds, so that each is an independent estimate of the same thing; within a half, a side's
/// paths come from Owen-scrambled sequences. The same bits for any number of threads, and whether traced at once or
/// continued.
class SidePaths {
  public:
    /// `with_bark` false leaves bark patches at zero paths. Points and what they refer to must outlive it.
    SidePaths(const PatchScene& scene, const PatchPoints& points, std::uint64_t seed, bool with_bark);
    /// Of some leaves only: `leaves` says of each leaf whether it is traced.
    SidePaths(const PatchScene& scene, const PatchPoints& points, std::uint64_t seed, const std::vector<bool>& leaves);
    /// Traces until every leaf side has `paths` of them (an odd number is rounded up), shared among the leaf's patches
    /// by area but at least 1 in each half; every bark side gets the full number. Throws Stopped when the user asks to
    /// stop.
    void extend_to(std::uint32_t paths, const PathTracer& tracer, Progress& progress);
    std::uint32_t paths_per_side() const { return 2 * half_paths_; }
    std::uint64_t paths_traced() const;
    const SideSums& side(std::size_t patch, bool front) const { return sides_[2 * patch + (front ? 0 : 1)]; }
    /// Radiance of both sides of every patch: by one half (0 or 1) or by all paths (-1).
    SideRadiance radiance(const std::vector<Optics>& optics, int half = -1) const;

  private:
    std::uint32_t paths_of(std::size_t patch, std::uint32_t half_paths) const;

    const PatchScene& scene_;
    const PatchPoints& points_;
    std::uint64_t seed_;
    std::uint32_t half_paths_ = 0;
    std::vector<float> share_; ///< of its leaf's area; 0 = no paths
    std::vector<SideSums> sides_;
};

/// MRE (accuracy.h) of the mean of two independent estimates of equal effort, from their difference: the mean's error
/// and half the difference have the same distribution when errors are symmetric.
double half_sample_error(const std::vector<glm::vec3>& first, const std::vector<glm::vec3>& second);

} // namespace kokage
