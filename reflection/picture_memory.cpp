#include "reflection/picture_memory.h"
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

} // namespace kokage
