#include "tests/benchmark/render_plan.h"

namespace kokage {

RenderPlan render_plan(bool quick) {
    const double usual = RenderOptions().error, fine = 0.05; // usual: what users get
    RenderPlan plan{.width = 480,
                    .height = 360,
                    .every_row = 8,
                    .every_column = 7,
                    .truth_samples = 8192,
                    .fast = {{usual, 4}, {usual, 16}, {usual, 24}, {usual, 32}, {usual, 64}, {fine, 16}},
                    .traced = {16, 64, 256, 1024},
                    .map_samples = 256};
    if (quick)
        return plan;
    plan.width = 960;
    plan.height = 720;
    plan.every_row = plan.every_column = 15; // as many pixels as the quick plan's
    plan.truth_samples = 32768;
    plan.fast.insert(plan.fast.end(), {{fine, 20}, {fine, 64}});
    plan.traced.push_back(4096);
    plan.map_samples = 1024;
    return plan;
}

PictureOptions judged_pixels(const RenderPlan& plan, const PictureOptions& picture) {
    PictureOptions judged = picture;
    judged.every_row = plan.every_row;
    judged.every_column = plan.every_column;
    return judged;
}

} // namespace kokage
