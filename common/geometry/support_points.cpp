#include "common/geometry/support_points.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kokage {
namespace {

/// The points sorted into the cells of a grid, each with the box of its points: a cell whose box does not reach beyond
/// the farthest point found so far need not be looked into.
class PointGrid {
  public:
    explicit PointGrid(std::span<const glm::vec3> points) {
        constexpr float kFar = std::numeric_limits<float>::max();
        glm::vec3 low(kFar), high(-kFar);
        for (const glm::vec3& point : points)
            if (is_finite(point)) {
                low = glm::min(low, point);
                high = glm::max(high, point);
            }
        const glm::vec3 cells_a_unit = float(kCells) / glm::max(high - low, 1e-30f);
        const auto cell_of = [&](const glm::vec3& point) {
            const glm::vec3 place = glm::clamp((point - low) * cells_a_unit, 0.f, kCells - 0.5f);
            return (std::size_t(place.z) * kCells + std::size_t(place.y)) * kCells + std::size_t(place.x);
        };
        std::vector<std::uint32_t> begin(kCells * kCells * kCells + 1, 0);
        for (const glm::vec3& point : points)
            if (is_finite(point))
                ++begin[cell_of(point) + 1];
        for (std::size_t c = 1; c < begin.size(); ++c)
            begin[c] += begin[c - 1];
        std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
        points_.resize(begin.back());
        for (std::uint32_t i = 0; i < points.size(); ++i)
            if (is_finite(points[i]))
                points_[next[cell_of(points[i])]++] = {points[i] - low, i}; // small numbers are told apart better
        for (std::size_t c = 0; c + 1 < begin.size(); ++c)
            if (begin[c] < begin[c + 1])
                add_cell(begin[c], begin[c + 1]);
        reach_.resize(cells_.size());
    }

    bool empty() const { return points_.empty(); }

    std::uint32_t farthest(const glm::vec3& direction) {
        std::size_t most = 0;
        for (std::size_t c = 0; c < cells_.size(); ++c) {
            const Cell& cell = cells_[c];
            reach_[c] = glm::dot(direction, glm::mix(cell.low, cell.high, glm::greaterThan(direction, glm::vec3(0.f))));
            if (reach_[c] > reach_[most])
                most = c;
        }
        Found found;
        look_into(cells_[most], direction, found);
        for (std::size_t c = 0; c < cells_.size(); ++c)
            if (c != most && reach_[c] > found.distance)
                look_into(cells_[c], direction, found);
        return found.index;
    }

  private:
    struct Point {
        glm::vec3 place; ///< from the lowest corner of all
        std::uint32_t index;
    };
    struct Cell {
        std::uint32_t begin, end;
        glm::vec3 low, high; ///< bounds of its points
    };
    struct Found {
        float distance = -std::numeric_limits<float>::infinity();
        std::uint32_t index = 0;
    };

    static bool is_finite(const glm::vec3& point) {
        return std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z);
    }

    void add_cell(std::uint32_t begin, std::uint32_t end) {
        Cell cell{begin, end, points_[begin].place, points_[begin].place};
        for (std::uint32_t i = begin; i < end; ++i) {
            cell.low = glm::min(cell.low, points_[i].place);
            cell.high = glm::max(cell.high, points_[i].place);
        }
        cells_.push_back(cell);
    }

    void look_into(const Cell& cell, const glm::vec3& direction, Found& found) const {
        for (std::uint32_t i = cell.begin; i < cell.end; ++i)
            if (const float distance = glm::dot(direction, points_[i].place); distance > found.distance)
                found = {distance, points_[i].index};
    }

    static constexpr std::size_t kCells = 16; ///< along an axis
    std::vector<Point> points_;               ///< cell by cell
    std::vector<Cell> cells_;                 ///< those with points
    std::vector<float> reach_;                ///< of each cell's box, in the direction that is looked in
};

} // namespace

std::vector<std::uint32_t> support_points(std::span<const glm::vec3> points, std::span<const glm::vec3> directions) {
    PointGrid grid(points);
    std::vector<std::uint32_t> farthest;
    if (grid.empty())
        return farthest;
    for (const glm::vec3& direction : directions)
        farthest.push_back(grid.farthest(direction));
    std::sort(farthest.begin(), farthest.end());
    farthest.erase(std::unique(farthest.begin(), farthest.end()), farthest.end());
    return farthest;
}

} // namespace kokage
