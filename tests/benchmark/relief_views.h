#pragma once
// The rays that `kokage bench relief` sends: pictures of a plane and of a sphere covered with a tile, in relief space.
#include "reflection/relief/relief_ray.h"

#include <string>
#include <vector>

namespace kokage {

/// How the tile lies on the surface at a pixel.
struct ReliefFrame {
    glm::vec3 tangent{1, 0, 0}, bitangent{0, 1, 0},
        normal{0, 0, 1}; ///< in the picture's frame: x right, y up, z to the eye
    ReliefScale scale;
};

struct ReliefView {
    std::string name;
    int width = 0, height = 0;           ///< of the picture, in pixels
    std::vector<ReliefRay> rays;         ///< row by row
    std::vector<std::uint32_t> pixels{}; ///< of each ray: column + row * width
    std::vector<ReliefFrame> frames{};   ///< of each ray; the sphere's alone
};

/// A square of three tiles seen in parallel projection, `degrees` from its normal: `side` x `side` rays that lie evenly
/// on it, the azimuth drawn from `seed`.
ReliefView plane_view(float degrees, int side, unsigned seed);

/// A sphere around which the tile goes `around` times (half as often from pole to pole), seen in parallel projection:
/// what is seen of it has all angles. Rays run in the tangent plane of the point that they meet.
ReliefView sphere_view(int side, int around = 8);

/// The plane at 10, 25, 40, 55, 70 and 85 degrees, then the sphere.
std::vector<ReliefView> benchmark_views(int side);

} // namespace kokage
