#pragma once
// What no number of lines mends: mostly that light leaves a side as if the side were lit evenly. Assumed where it is
// known well enough, measured where it is not.
#include "common/services/work_report.h"
#include "foliage/bundles/bounce_sweeps.h"
#include "foliage/bundles/error_by_paths.h"
#include "foliage/bundles/facets.h"

namespace kokage::bundles {

/// Error of a solution (MRE; see foliage/accuracy.h).
struct SolutionError {
    double all = 0;   ///< with the sampling error
    double model = 0; ///< of that, what more lines would not mend
    bool measured = false;
};

/// What halves of the lines show (an MRE), and what so many lines usually show.
struct SamplingError {
    double shown = 0, usual = 0;
};

/// What a solution is for. References must outlive it.
struct LightAndMatter {
    const Environment& environment;
    const std::vector<Optics>& optics;
    int max_bounces = 0; ///< as in ShadingOptions
};

class ModelError {
  public:
    /// `assumed`: of crowns of many whole leaves of about one size under ordinary light. The scene must outlive it.
    ModelError(const PatchScene& scene, const Facets& facets, double assumed);

    /// The error where nothing need be measured: the sampling error, which halves of the lines show, dwarfs what there
    /// may be beside it; or there was a measurement since when no light moved, no leaf changed its colour, and at most
    /// a seventh of the light came to come from elsewhere (another sky, a stronger lamp). Empty where there is need.
    std::optional<SolutionError> known(const SamplingError& sampling, const LightAndMatter& now);
    /// Measures, by paths to a few leaves, and remembers. `radiance` and `half_differences` per side. Called again for
    /// the same solution, it takes other leaves and other paths and gives what both say together.
    SolutionError measure(const SamplingError& sampling, const std::vector<Rgb>& radiance,
                          const std::vector<Rgb>& half_differences, const LightAndMatter& now, std::uint64_t seed,
                          Progress& progress, WorkReport& report);
    /// True if what known() tells was measured twice. Who stops at the first estimate that is low enough meets lucky
    /// ones more often than not: it takes a second look.
    bool measured_twice() const { return measured_ && measured_->times > 1; }
    /// Forgets the last measurement (when lines are drawn anew: it told of other lines, and few of them tell little of
    /// what is left without them).
    void forget() { measured_.reset(); }
    std::size_t bytes() const { return paths_ ? paths_->bytes() : 0; }

  private:
    /// What an error depends on, beside the lines.
    struct Conditions {
        std::vector<glm::vec3> lights; ///< where they stand
        std::vector<glm::vec3> shares; ///< see light_shares.h
        std::vector<Optics> optics;
    };
    struct Measured {
        double beyond = 0; ///< the square of the error less that of the sampling error; may be negative
        Conditions conditions;
        TracedSides traced;
        int times = 0;
    };
    Conditions conditions(const LightAndMatter& now);
    static double moved(const Conditions& before, const Conditions& now);
    static double evenness(const SamplingError& sampling);
    SolutionError error(double sampling_error) const;

    const PatchScene& scene_;
    double assumed_, largest_;
    std::optional<Measured> measured_;
    std::unique_ptr<ErrorByPaths> paths_; ///< built for the first measurement
    std::optional<glm::vec3> centre_;     ///< found when it is first needed
};

} // namespace kokage::bundles
