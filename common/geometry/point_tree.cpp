#include "common/geometry/point_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kokage {
namespace {

double square_distance(const glm::vec3& a, const glm::vec3& b) {
    const glm::dvec3 difference = glm::dvec3(a) - glm::dvec3(b);
    return glm::dot(difference, difference);
}

NearestPoint result_of(double square, std::uint32_t index) {
    return {index, index == ~0u ? 0.f : float(std::sqrt(square))};
}

} // namespace

PointTree::PointTree(std::span<const glm::vec3> points, std::span<const std::uint32_t> indices) {
    points_.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
        points_.push_back({points[i], indices.empty() ? std::uint32_t(i) : indices[i]});
    axes_.resize(points_.size());
    build(0, points_.size());
}

void PointTree::build(std::size_t begin, std::size_t end) {
    if (begin >= end)
        return;
    glm::vec3 low = points_[begin].position, high = low;
    for (std::size_t i = begin; i < end; ++i) {
        low = glm::min(low, points_[i].position);
        high = glm::max(high, points_[i].position);
    }
    const glm::vec3 extent = high - low;
    const std::size_t axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    const std::size_t middle = begin + (end - begin) / 2;
    const auto before = [axis](const Point& a, const Point& b) {
        return a.position[axis] != b.position[axis] ? a.position[axis] < b.position[axis] : a.index < b.index;
    };
    std::nth_element(points_.begin() + std::ptrdiff_t(begin), points_.begin() + std::ptrdiff_t(middle),
                     points_.begin() + std::ptrdiff_t(end), before);
    axes_[middle] = static_cast<unsigned char>(axis);
    build(begin, middle);
    build(middle + 1, end);
}

void PointTree::search(std::size_t begin, std::size_t end, const glm::vec3& place, double& best_square,
                       std::uint32_t& best) const {
    if (begin >= end)
        return;
    const std::size_t middle = begin + (end - begin) / 2;
    const Point& point = points_[middle];
    const double square = square_distance(point.position, place);
    if (square < best_square || (square == best_square && point.index < best)) {
        best_square = square;
        best = point.index;
    }
    const double offset = double(place[axes_[middle]]) - double(point.position[axes_[middle]]);
    const bool left_first = offset < 0;
    for (const bool left : {left_first, !left_first})
        if (left == left_first || offset * offset <= best_square) {
            if (left)
                search(begin, middle, place, best_square, best);
            else
                search(middle + 1, end, place, best_square, best);
        }
}

NearestPoint PointTree::nearest(const glm::vec3& place) const {
    double square = std::numeric_limits<double>::infinity();
    std::uint32_t index = ~0u;
    search(0, points_.size(), place, square, index);
    return result_of(square, index);
}

void PointTree::collect(std::size_t begin, std::size_t end, const glm::vec3& place, double square,
                        std::vector<std::uint32_t>& found) const {
    if (begin >= end)
        return;
    const std::size_t middle = begin + (end - begin) / 2;
    const Point& point = points_[middle];
    if (square_distance(point.position, place) <= square)
        found.push_back(point.index);
    const double offset = double(place[axes_[middle]]) - double(point.position[axes_[middle]]);
    if (offset <= 0 || offset * offset <= square)
        collect(begin, middle, place, square, found);
    if (offset >= 0 || offset * offset <= square)
        collect(middle + 1, end, place, square, found);
}

std::vector<std::uint32_t> PointTree::within(const glm::vec3& place, float distance) const {
    std::vector<std::uint32_t> found;
    collect(0, points_.size(), place, double(distance) * double(distance), found);
    std::sort(found.begin(), found.end());
    return found;
}

void GrowingPointTree::add(const glm::vec3& point) {
    std::vector<glm::vec3> points{point};
    std::vector<std::uint32_t> indices{std::uint32_t(count_++)};
    std::size_t k = 0;
    for (; k < trees_.size() && trees_[k].size() > 0; ++k) {
        for (const PointTree::Point& p : trees_[k].points_) {
            points.push_back(p.position);
            indices.push_back(p.index);
        }
        trees_[k] = PointTree();
    }
    if (k == trees_.size())
        trees_.emplace_back();
    trees_[k] = PointTree(points, indices);
}

NearestPoint GrowingPointTree::nearest(const glm::vec3& place) const {
    double square = std::numeric_limits<double>::infinity();
    std::uint32_t index = ~0u;
    for (const PointTree& tree : trees_)
        tree.search(0, tree.points_.size(), place, square, index);
    return result_of(square, index);
}

std::vector<std::uint32_t> GrowingPointTree::within(const glm::vec3& place, float distance) const {
    std::vector<std::uint32_t> found;
    for (const PointTree& tree : trees_)
        tree.collect(0, tree.points_.size(), place, double(distance) * double(distance), found);
    std::sort(found.begin(), found.end());
    return found;
}

} // namespace kokage
