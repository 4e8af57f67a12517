#pragma once
// What no number of lines mends: mostly that light leaves a side as if the side were lit evenly. Assumed where it is
// known well enough, measured where it is not.
#include "common/services/work_report.h"
#include "foliage/bundles/bounce_sweeps.h"
#include "foliage/bundles/error_by_paths.h"
#include "foliage/bundles/facets.h"

namespace kokage::bundles {

/// Error of a solution (MRE, DESIGN 3).
struct SolutionError {
    double all = 0;   ///< with the sampling error
    double model = 0; ///< of that, what more lines would not mend
    bool measured = false;
};

/// What a solution is for. References must outlive it.
struct LightAndMatter {
    const Environment& environment;
    const std::vector<Optics>& optics;
    int max_bounces = 0; ///< as in ShadingOptions
};

class ModelError {
  public:
    /// `assumed`: of crowns of many whole leaves of about one size. The scene must outlive it.
    ModelError(const PatchScene& scene, const Facets& facets, double assumed);

    /// The error where nothing need be measured: the sampling error, which halves of the lines show, dwarfs what there
    /// may be beside it; or there was a measurement since when no light moved and no leaf changed its colour. Empty
    /// where there is need.
    std::optional<SolutionError> known(double sampling_error, const LightAndMatter& now) const;
    /// `radiance` and `half_differences` per side. `fragments`, of all lines: paths take at most about a quarter of the
    /// time that they took, though what a few leaves need is always traced.
    SolutionError measure(double sampling_error, const std::vector<Rgb>& radiance,
                          const std::vector<Rgb>& half_differences, const LightAndMatter& now, std::uint64_t seed,
                          std::uint64_t fragments, Progress& progress, WorkReport& report);
    /// Forgets the last measurement (when lines are drawn anew).
    void forget() { measured_.reset(); }
    std::size_t bytes() const { return paths_ ? paths_->bytes() : 0; }

  private:
    struct Measured {
        double model_error = 0;
        std::vector<glm::vec3> lights; ///< where they stand
        std::vector<Optics> optics;
    };
    static Measured conditions(const LightAndMatter& now);

    const PatchScene& scene_;
    double assumed_, largest_;
    std::optional<Measured> measured_;
    std::unique_ptr<ErrorByPaths> paths_; ///< built for the first measurement
};

} // namespace kokage::bundles
