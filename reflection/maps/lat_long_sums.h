#pragma once
// Weighted sums over a lat-long image in double, by vectors: the inner loop of the brute-force baker.
#include "common/scene/image.h"
#include "reflection/maps/lobe.h"

#include <glm/glm.hpp>
#include <vector>

namespace kokage {

/// An image's pixels plane by plane, and where they are. Rows and columns are padded so that vectors may read on.
struct LatLongPlanes {
    int width = 0, height = 0;
    std::size_t stride = 0;
    std::vector<float> planes[3];                        ///< empty until set_pixels
    std::vector<double> row_theta, row_sine, row_cosine; ///< the angle from +Y
    std::vector<double> row_angle;                       ///< exact solid angle of a pixel
    std::vector<double> column_x, column_z; ///< direction = (row_sine column_x, row_cosine, row_sine column_z)
    LatLongPlanes(int image_width, int image_height);
    void set_pixels(const Image& image, float scale = 1); ///< values are multiplied by `scale`
    glm::dvec3 direction(int x, int y) const;
    glm::dvec3 pixel(int x, int y) const;
};

/// Sum of weights, and of weights times pixels.
struct LobeSums {
    double weight = 0; ///< of the whole lobe, also where a horizon cuts it
    glm::dvec3 radiance{0.0};
};

/// Over all pixels within the squared distance `reach` (and some beyond it) of a unit direction:
/// weight = dω (lobe relative to its value at the squared distance `nearest`). With a horizon (a unit normal; may be
/// null) a pixel counts by the share of its area above it: [R] eq 2's test cos φ >= 0, pixels being areas and not
/// points.
LobeSums sum_over_lobe(const LatLongPlanes& planes, const Lobe& lobe, const glm::dvec3& direction, double reach,
                       double nearest, const glm::dvec3* horizon = nullptr);

} // namespace kokage
