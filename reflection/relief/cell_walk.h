#pragma once
// A ray over the bilinear cells of a height field in double precision: cell by cell, each by the exact root of its
// quadratic. Private to relief.
#include "reflection/relief/bilinear_cell.h"
#include "reflection/relief/cell_by_cell.h"

#include <algorithm>
#include <array>
#include <limits>

namespace kokage {

/// What a ray must know of a height field to cross it.
struct TexelGrid {
    int width = 0, height = 0;
    HeightWrap wrap = HeightWrap::repeat;
};

inline constexpr double kNever = std::numeric_limits<double>::infinity();
inline constexpr double kBelowAll =
    1 + 1e-9; ///< rays end here, so that rounding does not end them above a surface of depth 1

/// The part of a ray that can hit anything, in texels: centres of texels at whole numbers.
struct TexelRay {
    glm::dvec3 origin{0.}, direction{0.}; ///< x, y in texels, depth; the origin is where the part begins
    double t_base = 0;                    ///< where that is on the ray as it was given
    double length = -1;                   ///< of the part, in t; negative: nothing can be hit
    glm::dvec2 moved{0.};                 ///< tiles that the origin was moved by
};

inline bool is_finite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Where to move `coordinate` of a ray's beginning, so that no precision is lost far away and the ray sees the same.
inline double near_tile(double coordinate, HeightWrap wrap) {
    if (wrap == HeightWrap::repeat)
        return coordinate - std::floor(coordinate);
    // From beyond this no ray gets back to the tile: all that it sees is the border.
    constexpr double beyond = 2 * double(kMostTilesCrossed);
    return std::clamp(coordinate, -beyond, beyond);
}

inline TexelRay texel_ray(const TexelGrid& grid, const ReliefRay& ray) {
    TexelRay r;
    if (!is_finite(ray.origin) || !is_finite(ray.direction) || std::isnan(ray.t_most))
        return r;
    const glm::dvec3 origin(ray.origin), direction(ray.direction);
    if (origin.z < 0) {
        if (!(direction.z > 0))
            return r;
        r.t_base = -origin.z / direction.z;
    }
    const glm::dvec3 start(glm::dvec2(origin) + r.t_base * glm::dvec2(direction), std::max(0., origin.z));
    r.length = std::min(double(ray.t_most), double(std::numeric_limits<float>::max())) - r.t_base;
    if (direction.z > 0)
        r.length = std::min(r.length, std::max(0., (kBelowAll - start.z) / direction.z));
    if (direction.z < 0)
        r.length = std::min(r.length, start.z / -direction.z);
    const double tiles = std::max(std::abs(direction.x), std::abs(direction.y));
    if (tiles > 0)
        r.length = std::min(r.length, double(kMostTilesCrossed) / tiles);
    else if (direction.z == 0)
        r.length = std::min(r.length, 0.);
    const glm::dvec2 size(grid.width, grid.height), near(near_tile(start.x, grid.wrap), near_tile(start.y, grid.wrap));
    r.moved = near - glm::dvec2(start);
    r.origin = glm::dvec3(near * size - 0.5, start.z);
    r.direction = glm::dvec3(glm::dvec2(direction) * size, direction.z);
    return r;
}

/// Ray's depth - surface's depth within a cell is c + b s + a s², s from `start` on: >= 0 is below the surface.
struct CellQuadratic {
    double a = 0, b = 0, c = 0;

    double at(double s) const { return c + s * (b + s * a); }

    /// The first s in [0, length] where it is not negative; kNever where there is none.
    double first_not_negative(double length) const {
        if (c >= 0)
            return 0;
        double least = kNever;
        const auto take = [&](double s) {
            if (s >= 0 && s <= length)
                least = std::min(least, s);
        };
        const double discriminant = b * b - 4 * a * c;
        if (discriminant >= 0) {
            const double sum = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
            if (a != 0)
                take(sum / a);
            if (sum != 0)
                take(c / sum);
        }
        // Rounding may lose a root that stands on the border: the end itself tells.
        return least < kNever ? least : length < kNever && at(length) >= 0 ? length : kNever;
    }
};

inline CellQuadratic ray_over_cell(const TexelRay& ray, const BilinearCell& cell, double start, double i, double j) {
    const glm::dvec3 p = ray.origin + start * ray.direction, d = ray.direction;
    const double u = p.x - i, v = p.y - j;
    return {-cell.duv * d.x * d.y, d.z - cell.du * d.x - cell.dv * d.y - cell.duv * (u * d.y + v * d.x),
            p.z - cell.depth(u, v)};
}

/// Calls visit(i, j, t_in, t_out) for the cells under the ray in their order, until it returns true.
template <class Visit>
void walk_cells(const TexelRay& ray, double t_first, double t_last, Visit&& visit) {
    const glm::dvec3 p = ray.origin + t_first * ray.direction;
    std::array<double, 2> cell{std::floor(p.x), std::floor(p.y)};
    const std::array<double, 2> origin{ray.origin.x, ray.origin.y}, direction{ray.direction.x, ray.direction.y};
    const auto crossing = [&](std::size_t axis) { // of the cell's far border
        if (direction[axis] == 0)
            return kNever;
        const double t = ((direction[axis] > 0 ? cell[axis] + 1 : cell[axis]) - origin[axis]) / direction[axis];
        return std::isnan(t) ? kNever : t;
    };
    for (std::size_t axis = 0; axis < 2;
         ++axis) // a ray that starts on a border and goes back stands in the cell before
        if (direction[axis] < 0 && crossing(axis) <= t_first)
            cell[axis] -= 1;
    for (double t = t_first;;) {
        const double next_x = crossing(0), next_y = crossing(1), next = std::max(t, std::min(next_x, next_y));
        if (visit((long long)(cell[0]), (long long)(cell[1]), t, std::min(next, t_last)) || !(next < t_last))
            return;
        const std::size_t axis = next_x <= next_y ? 0 : 1;
        cell[axis] += direction[axis] > 0 ? 1 : -1;
        t = next;
    }
}

/// The first hit from `start` on, which counts from the ray's part that can hit anything (TexelRay::t_base); cell_at(i,
/// j) gives the BilinearCell there.
template <class CellAt>
TrueReliefHit walk_to_hit(const TexelGrid& grid, const TexelRay& r, double start, CellAt&& cell_at) {
    TrueReliefHit hit;
    if (r.length < 0)
        return hit;
    walk_cells(r, std::min(start, r.length), r.length, [&](long long i, long long j, double t_in, double t_out) {
        ++hit.reads;
        const BilinearCell cell = cell_at(i, j);
        const double s = ray_over_cell(r, cell, t_in, double(i), double(j)).first_not_negative(t_out - t_in);
        if (s == kNever)
            return false;
        hit.t = r.t_base + t_in + s;
        const glm::dvec3 p = r.origin + (t_in + s) * r.direction;
        const glm::dvec2 size(grid.width, grid.height), inside = glm::clamp(glm::dvec2(p) - glm::dvec2(i, j), 0., 1.);
        hit.depth = cell.depth(inside.x, inside.y);
        hit.slope = glm::dvec2(cell.du + inside.y * cell.duv, cell.dv + inside.x * cell.duv) * size;
        hit.coordinate = (glm::dvec2(p) + 0.5) / size;
        hit.coordinate -= grid.wrap == HeightWrap::repeat ? glm::floor(hit.coordinate) : r.moved;
        return true;
    });
    return hit;
}

} // namespace kokage
