#include "reflection/maps/dome_pyramid.h"
#include "common/environment/lat_long.h"
#include "common/geometry/point_tree.h"
#include "common/services/parallel.h"

#include <mutex>
#include <stdexcept>

namespace kokage {

namespace {

Dome make_dome(int edges) {
    Dome result{geodesic_dome(edges), {}};
    const std::vector<glm::dvec3>& directions = result.dome.directions;
    const std::vector<glm::vec3> points(directions.begin(), directions.end());
    const PointTree tree(points);
    for (int symmetry = 0; symmetry < kDomeSymmetries; ++symmetry) {
        std::vector<std::uint16_t>& vertex_of = result.vertex_of[std::size_t(symmetry)];
        vertex_of.resize(points.size());
        parallel_blocks(points.size(), 4096, [&](std::size_t begin, std::size_t end) {
            for (std::size_t v = begin; v < end; ++v) {
                const NearestPoint there = tree.nearest(apply_symmetry(symmetry, points[v]));
                if (!(there.distance < 1e-5f))
                    throw std::logic_error("a geodesic dome is not symmetric");
                vertex_of[v] = std::uint16_t(there.index);
            }
        });
    }
    return result;
}

} // namespace

const Dome& dome_of_level(int level) {
    static std::array<Dome, kDomeLevels> domes;
    static std::array<std::once_flag, kDomeLevels> made;
    const std::size_t l = std::size_t(level);
    std::call_once(made.at(l), [&] { domes[l] = make_dome(kDomeEdges[l]); });
    return domes[l];
}

DomeLight light_on_domes(const Image& image) {
    DomeLight light;
    Image level_image = image;
    for (int level = 0; level < kDomeLevels; ++level) {
        level_image = reduce_lat_long(std::move(level_image), kPyramidWidths[level]);
        const std::vector<glm::dvec3>& directions = dome_of_level(level).dome.directions;
        std::vector<glm::vec3>& radiance = light[std::size_t(level)];
        radiance.resize(directions.size());
        parallel_blocks(directions.size(), 2048, [&](std::size_t begin, std::size_t end) {
            for (std::size_t v = begin; v < end; ++v)
                radiance[v] = lat_long_radiance(level_image, glm::vec3(directions[v]));
        });
    }
    return light;
}

} // namespace kokage
