#pragma once
// Nearest-neighbour search among points: a balanced k-d tree, and one that grows.
#include "common/types.h"

#include <cstddef>
#include <span>
#include <vector>

namespace kokage {

struct NearestPoint {
    std::uint32_t index = ~0u; ///< ~0u if there is no point
    float distance = 0;
    bool found() const { return index != ~0u; }
};

/// A k-d tree over finite points (copied). Ties go to the lower index, so that results do not depend on the tree's
/// shape.
class PointTree {
  public:
    PointTree() = default;
    /// `indices`: what `nearest` reports for each point; empty = 0, 1, 2, ...
    explicit PointTree(std::span<const glm::vec3> points, std::span<const std::uint32_t> indices = {});
    NearestPoint nearest(const glm::vec3& place) const;
    /// Every point at most so far away, in rising order.
    std::vector<std::uint32_t> within(const glm::vec3& place, float distance) const;
    std::size_t size() const { return points_.size(); }

  private:
    friend class GrowingPointTree;
    void build(std::size_t begin, std::size_t end);
    void search(std::size_t begin, std::size_t end, const glm::vec3& place, double& best_square,
                std::uint32_t& best) const;
    void collect(std::size_t begin, std::size_t end, const glm::vec3& place, double square,
                 std::vector<std::uint32_t>& found) const;

    struct Point {
        glm::vec3 position;
        std::uint32_t index;
    };
    std::vector<Point> points_; ///< the middle of every range is its root
    std::vector<unsigned char> axes_;
};

/// Points may be added between searches: a few balanced trees of doubling sizes (Bentley and Saxe 1980).
class GrowingPointTree {
  public:
    void add(const glm::vec3& point); ///< its index is the number of points before it
    NearestPoint nearest(const glm::vec3& place) const;
    std::vector<std::uint32_t> within(const glm::vec3& place, float distance) const; ///< as PointTree's
    std::size_t size() const { return count_; }

  private:
    std::vector<PointTree> trees_; ///< tree k is empty or has 2^k points
    std::size_t count_ = 0;
};

} // namespace kokage
