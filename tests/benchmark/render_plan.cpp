#include "tests/benchmark/render_plan.h"

namespace kokage {

RenderPlan render_plan(bool quick) {
    const double error = RenderOptions().error; // what users get
    if (quick)
        return {480, 360, 8, 7, 8192, {{error, 4}, {error, 16}, {error, 32}, {error, 64}}, {16, 64, 256, 1024}, 256};
    return {640,
            480,
            10,
            10,
            32768,
            {{error, 4}, {error, 16}, {error, 32}, {error, 64}, {0.05, 64}},
            {16, 64, 256, 1024, 4096},
            1024};
}

PictureOptions judged_pixels(const RenderPlan& plan, const PictureOptions& picture) {
    PictureOptions judged = picture;
    judged.every_row = plan.every_row;
    judged.every_column = plan.every_column;
    return judged;
}

} // namespace kokage
