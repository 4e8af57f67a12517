#include "reflection/relief/cell_by_cell.h"
#include "reflection/relief/bilinear_cell.h"

#include <algorithm>
#include <array>

namespace kokage {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kBelowAll = 1 + 1e-9; ///< rays end here, so that rounding does not end them above a surface of depth 1

/// The part of a ray that can hit anything, in texels: centres of texels at whole numbers.
struct TexelRay {
    glm::dvec3 origin{0.}, direction{0.}; ///< x, y in texels, depth; the origin is where the part begins
    double t_base = 0;                    ///< where that is on the ray as it was given
    double length = -1;                   ///< of the part, in t; negative: nothing can be hit
    glm::dvec2 moved{0.};                 ///< tiles that the origin was moved by
};

bool is_finite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Where to move `coordinate` of a ray's beginning, so that no precision is lost far away and the ray sees the same.
double near_tile(double coordinate, HeightWrap wrap) {
    if (wrap == HeightWrap::repeat)
        return coordinate - std::floor(coordinate);
    // From beyond this no ray gets back to the tile: all that it sees is the border.
    constexpr double beyond = 2 * double(kMostTilesCrossed);
    return std::clamp(coordinate, -beyond, beyond);
}

TexelRay texel_ray(const HeightField& field, const ReliefRay& ray) {
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
    const glm::dvec2 size(field.width, field.height),
        near(near_tile(start.x, field.wrap), near_tile(start.y, field.wrap));
    r.moved = near - glm::dvec2(start);
    r.origin = glm::dvec3(near * size - 0.5, start.z);
    r.direction = glm::dvec3(glm::dvec2(direction) * size, direction.z);
    return r;
}

/// Ray's depth - surface's depth within a cell is c + b s + a s², s from `start` on: >= 0 is below the surface.
struct Quadratic {
    double a = 0, b = 0, c = 0;

    double at(double s) const { return c + s * (b + s * a); }
};

Quadratic ray_over_cell(const TexelRay& ray, const BilinearCell& cell, double start, double i, double j) {
    const glm::dvec3 p = ray.origin + start * ray.direction, d = ray.direction;
    const double u = p.x - i, v = p.y - j;
    return {-cell.duv * d.x * d.y, d.z - cell.du * d.x - cell.dv * d.y - cell.duv * (u * d.y + v * d.x),
            p.z - cell.depth(u, v)};
}

/// The first s in [0, length] where the quadratic is not negative; kNever where there is none.
double first_not_negative(const Quadratic& q, double length) {
    if (q.c >= 0)
        return 0;
    double least = kNever;
    const auto take = [&](double s) {
        if (s >= 0 && s <= length)
            least = std::min(least, s);
    };
    const double discriminant = q.b * q.b - 4 * q.a * q.c;
    if (discriminant >= 0) {
        const double sum = -0.5 * (q.b + std::copysign(std::sqrt(discriminant), q.b));
        if (q.a != 0)
            take(sum / q.a);
        if (sum != 0)
            take(q.c / sum);
    }
    // Rounding may lose a root that stands on the border: the end itself tells.
    return least < kNever ? least : length < kNever && q.at(length) >= 0 ? length : kNever;
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

} // namespace

TrueReliefHit true_relief_hit(const HeightField& field, const ReliefRay& ray) {
    TrueReliefHit hit;
    const TexelRay r = texel_ray(field, ray);
    if (r.length < 0)
        return hit;
    walk_cells(r, 0, r.length, [&](long long i, long long j, double t_in, double t_out) {
        ++hit.reads;
        const BilinearCell cell = bilinear_cell(field, i, j);
        const double s = first_not_negative(ray_over_cell(r, cell, t_in, double(i), double(j)), t_out - t_in);
        if (s == kNever)
            return false;
        hit.t = r.t_base + t_in + s;
        const glm::dvec3 p = r.origin + (t_in + s) * r.direction;
        const glm::dvec2 size(field.width, field.height), inside = glm::clamp(glm::dvec2(p) - glm::dvec2(i, j), 0., 1.);
        hit.depth = cell.depth(inside.x, inside.y);
        hit.slope = glm::dvec2(cell.du + inside.y * cell.duv, cell.dv + inside.x * cell.duv) * size;
        hit.coordinate = (glm::dvec2(p) + 0.5) / size;
        hit.coordinate -= field.wrap == HeightWrap::repeat ? glm::floor(hit.coordinate) : r.moved;
        return true;
    });
    return hit;
}

double greatest_depth_below(const HeightField& field, const ReliefRay& ray, double t0, double t1) {
    const TexelRay r = texel_ray(field, ray);
    double greatest = -kNever;
    t0 = std::max(t0 - r.t_base, 0.);
    t1 = std::min(t1 - r.t_base, r.length);
    if (!(t0 <= t1))
        return greatest;
    walk_cells(r, t0, t1, [&](long long i, long long j, double t_in, double t_out) {
        const Quadratic q = ray_over_cell(r, bilinear_cell(field, i, j), t_in, double(i), double(j));
        const double length = t_out - t_in;
        greatest = std::max({greatest, q.at(0), q.at(length)});
        const double top = q.a < 0 ? -q.b / (2 * q.a) : -1;
        if (top > 0 && top < length)
            greatest = std::max(greatest, q.at(top));
        return false;
    });
    return greatest;
}

namespace {

class CellByCellTracer final : public ReliefTracer {
  public:
    explicit CellByCellTracer(const HeightField& field) : field_(field) {}

    void trace(std::span<const ReliefRay> rays, std::span<ReliefHit> hits) const override {
        for (std::size_t k = 0; k < rays.size(); ++k) {
            const TrueReliefHit hit = true_relief_hit(field_, rays[k]);
            hits[k] = {float(hit.t), glm::vec2(hit.coordinate), float(hit.depth), glm::vec2(hit.slope), hit.reads};
            if (field_.wrap == HeightWrap::repeat) // 1 - 1e-12 is 1 as a float
                hits[k].coordinate -= glm::floor(hits[k].coordinate);
        }
    }
    void occluded(std::span<const ReliefRay> rays, std::span<std::uint8_t> hidden,
                  std::span<std::uint32_t> reads) const override {
        for (std::size_t k = 0; k < rays.size(); ++k) {
            const TrueReliefHit hit = true_relief_hit(field_, rays[k]);
            hidden[k] = hit.found();
            if (!reads.empty())
                reads[k] = hit.reads;
        }
    }
    std::size_t bytes() const override { return field_.bytes(); }

  private:
    const HeightField& field_;
};

} // namespace

std::unique_ptr<ReliefTracer> make_cell_by_cell_tracer(const HeightField& field) {
    return std::make_unique<CellByCellTracer>(field);
}

} // namespace kokage
