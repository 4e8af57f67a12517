#include "reflection/picture_memory.h"
#include "reflection/final_gather.h"
#include "reflection/sample_plan.h"

namespace kokage {

double picture_bytes(const PictureOptions& options, int threads) {
    const double pixels = double(options.width) * double(options.height), columns = double(options.width) + 2;
    const double picture = pixels * double(sizeof(float)) * (options.layers ? 21 : 4);
    // Of every thread: first rays of a band's squares, and all rays of a row, which may have more than others.
    constexpr double kMoreInARow = 3;
    const double rays = columns * (double(Film::kBandRows) * SamplePlan::first_samples(options.samples) +
                                   kMoreInARow * double(options.samples));
    return picture + Film::bytes(options) + double(threads) * rays * double(sizeof(CameraSample));
}

double light_bytes(const PictureOptions& options, const PatchScene& scene, int threads) {
    double smooth_triangles = 0;
    for (const Patch& patch : scene.patches)
        if (patch.kind == PatchKind::bark)
            smooth_triangles += patch.triangle_count;
    const auto patches = double(scene.patches.size()), triangles = double(scene.triangles.size());
    // Closed surfaces have half as many corners as triangles, hard edges up to six times as many.
    const double corners = 0.75 * smooth_triangles;
    constexpr double kOfCorner = 120; // while corners are joined
    const double joining =
        smooth_triangles > 0 ? 12 * triangles + 4 * double(scene.positions.size()) + kOfCorner * corners : 0;
    return 2 * (patches + corners) * double(sizeof(glm::vec3)) + joining +
           gathering_bytes(options, patches, corners, threads);
}

} // namespace kokage
