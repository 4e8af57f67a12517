#pragma once
// One scene of the renderer's benchmark: its truth, and records of its pictures.
#include "tests/benchmark/render_judge.h"
#include "tests/benchmark/render_plan.h"
#include "viewer/scene/scene_description.h"

#include <filesystem>

namespace kokage {

class RenderMeasurement {
  public:
    /// Assembles the scene and finds its truth. `plan` and `progress` must outlive it.
    RenderMeasurement(const SceneDescription& description, const RenderPlan& plan, const TruthOptions& truth,
                      Progress& progress);

    const PictureTruth& truth() const { return truth_; }

    /// Of the picture by the fast way, which is left in `radiance`. At 32 samples its errors are split, too
    /// (split_errors, split_bias).
    PictureRecord fast(const FastEffort& effort, Image& radiance) const;
    /// Of path tracing: error of the judged pixels, traced with all samples, time in proportion to them.
    PictureRecord traced(int samples);
    /// A small fast picture, a path-traced one and the map of what they differ by, side by side. Says what its colours
    /// mean.
    std::string save_error_map(const std::filesystem::path& file) const;

  private:
    PictureRecord record_of(const std::string& method, int samples) const;
    RenderedScene draw(const FastEffort& effort, PictureOptions picture) const;
    Picture trace(PictureOptions picture, int samples) const;
    void split(const FastEffort& effort, const Image& radiance, PictureRecord& record) const;
    void time_tracing();

    const RenderPlan& plan_;
    Progress& progress_;
    const AssembledScene scene_;
    const std::string name_;
    const PictureOptions picture_;
    const PictureTruth truth_;
    double cpu_before_ = 0, cpu_per_sample_ = 0; ///< of path tracing
};

} // namespace kokage
