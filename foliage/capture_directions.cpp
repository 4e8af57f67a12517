#include "foliage/capture_directions.h"
#include "common/directions/legendre.h"

#include <algorithm>
#include <cmath>

namespace kokage {

namespace {

/// Adds value x overlap of the interval [low, high) of a row, both in units of cells, to the row's cells.
void spread(double low, double high, const glm::dvec3& value, std::vector<glm::dvec3>& cells) {
    const int last = int(cells.size()) - 1;
    for (int cell = std::min(int(low), last); cell <= last && double(cell) < high; ++cell)
        cells[std::size_t(cell)] += value * (std::min(high, cell + 1.0) - std::max(low, double(cell)));
}

} // namespace

std::size_t CaptureDirections::cell(const glm::vec3& direction) const {
    const double y = std::clamp(double(direction.y), -1.0, 1.0);
    const auto below = std::lower_bound(borders.begin() + 1, borders.end() - 1, y, std::greater<>());
    const std::size_t ring = std::size_t(below - (borders.begin() + 1));
    double u = 0.5 + std::atan2(double(direction.z), double(direction.x)) / (2 * kPiDouble);
    u -= std::floor(u);
    return ring * std::size_t(per_ring) + std::size_t(std::min(int(u * per_ring), per_ring - 1));
}

CaptureDirections make_capture_directions(int bands, int least_count) {
    CaptureDirections set;
    set.rings = std::max({bands, int(std::ceil(std::sqrt(std::max(least_count, 1) / 2.0))), 1});
    set.per_ring = 2 * set.rings;
    const std::vector<QuadratureNode> nodes = gauss_legendre(set.rings); // ascending
    set.borders.push_back(1);
    for (int ring = 0; ring < set.rings; ++ring) {
        const QuadratureNode& node = nodes[std::size_t(set.rings - 1 - ring)];
        const double y = node.x, radius = std::sqrt(std::max(0.0, 1 - y * y));
        set.borders.push_back(set.borders.back() - node.weight);
        for (int j = 0; j < set.per_ring; ++j) {
            const double azimuth = 2 * kPiDouble * ((j + 0.5) / set.per_ring - 0.5);
            set.directions.emplace_back(radius * std::cos(azimuth), y, radius * std::sin(azimuth));
            set.solid_angles.push_back(float(node.weight * 2 * kPiDouble / set.per_ring));
        }
    }
    set.borders.back() = -1;
    return set;
}

std::vector<glm::vec3> cell_means(const CaptureDirections& set, const Image& image) {
    std::vector<glm::dvec3> sums(set.size(), glm::dvec3(0.0)), row(std::size_t(set.per_ring));
    const double cells_per_pixel = double(set.per_ring) / image.width;
    std::size_t ring = 0;
    for (int y = 0; y < image.height; ++y) {
        std::fill(row.begin(), row.end(), glm::dvec3(0.0));
        for (int x = 0; x < image.width; ++x) {
            const float* pixel = image.at(x, y);
            spread(x * cells_per_pixel, (x + 1) * cells_per_pixel, glm::dvec3(pixel[0], pixel[1], pixel[2]), row);
        }
        const double top = std::cos(kPiDouble * y / image.height),
                     bottom = std::cos(kPiDouble * (y + 1) / image.height);
        while (ring + 1 < std::size_t(set.rings) && set.borders[ring + 1] >= top)
            ++ring;
        for (std::size_t r = ring; r < std::size_t(set.rings) && set.borders[r] > bottom; ++r) {
            const double overlap = std::min(top, set.borders[r]) - std::max(bottom, set.borders[r + 1]);
            if (overlap <= 0)
                continue;
            for (std::size_t j = 0; j < row.size(); ++j)
                sums[r * row.size() + j] += overlap * row[j];
        }
    }
    std::vector<glm::vec3> means(set.size());
    for (std::size_t i = 0; i < means.size(); ++i) {
        const std::size_t r = i / row.size();
        means[i] = glm::vec3(sums[i] / (set.borders[r] - set.borders[r + 1]));
    }
    return means;
}

} // namespace kokage
