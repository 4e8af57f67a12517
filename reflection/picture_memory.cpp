#include "reflection/picture_memory.h"
#include "reflection/final_gather.h"
#include "reflection/light_map_gloss.h"
#include "reflection/sample_plan.h"

namespace kokage {
namespace {

/// Closed surfaces have half as many corners as triangles, hard edges up to six times as many.
constexpr double kCornersOfTriangle = 0.75;

double smooth_triangles(const PatchScene& scene) {
    double count = 0;
    for (const Patch& patch : scene.patches)
        if (patch.kind == PatchKind::bark)
            count += patch.triangle_count;
    return count;
}

} // namespace

double picture_bytes(const PictureOptions& options, int threads) {
    const double pixels = double(options.width) * double(options.height), columns = double(options.width) + 2;
    const double picture = pixels * double(sizeof(float)) * (options.layers ? 21 : 4);
    // Of every thread: first rays of a band's squares, and all rays of a row, which may have more than others, twice:
    // as they are traced, and square by square.
    constexpr double kMoreInARow = 3;
    const double of_row = kMoreInARow * double(options.samples),
                 shaded = double(Film::kBandRows) * SamplePlan::first_samples(options.samples) + 2 * of_row,
                 coverage = RadianceSpread::kMostCoverageRays * of_row;
    const double of_column = shaded * double(sizeof(CameraSample)) + coverage * double(sizeof(CoverageRay)) +
                             double(Film::kBandRows) * double(sizeof(RadianceSpread));
    return picture + Film::bytes(options) + double(threads) * columns * of_column;
}

double light_bytes(const PictureOptions& options, const PatchScene& scene, int threads) {
    const double smooth = smooth_triangles(scene), corners = kCornersOfTriangle * smooth;
    const auto patches = double(scene.patches.size()), triangles = double(scene.triangles.size());
    constexpr double kOfCorner = 120; // while corners are joined
    const double joining = smooth > 0 ? 12 * triangles + 4 * double(scene.positions.size()) + kOfCorner * corners : 0;
    return 2 * (patches + corners) * double(sizeof(glm::vec3)) + joining +
           gathering_bytes(options, patches, corners, threads);
}

double light_map_bytes(const PatchScene& scene, std::span<const std::uint8_t> readers, int bands) {
    double reading = 0;
    for (std::size_t p = 0; p < readers.size(); ++p)
        if (readers[p])
            reading += scene.patches[p].triangle_count;
    if (reading == 0)
        return 0;
    const double places = double(scene.patches.size()) + kCornersOfTriangle * smooth_triangles(scene);
    return LightMapGloss::most_bytes(places, kCornersOfTriangle * reading, bands);
}

} // namespace kokage
