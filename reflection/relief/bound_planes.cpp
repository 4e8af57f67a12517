#include "reflection/relief/bound_planes.h"
#include "common/services/checked_file.h"
#include "common/services/error.h"
#include "reflection/relief/bilinear_cell.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <utility>

namespace kokage {
namespace {

void check(const HeightField& field) {
    const auto refuse = [](const std::string& why) { throw InputError("height field: " + why); };
    if (field.width < 1 || field.height < 1)
        refuse("has no texels");
    if (std::max(field.width, field.height) >= BoundPlanes::kMostSide)
        refuse(std::to_string(field.width) + " x " + std::to_string(field.height) + " texels; at most " +
               std::to_string(BoundPlanes::kMostSide - 1) + " on a side can be traced: make the map smaller");
    if (field.depths.size() != std::size_t(field.width) * std::size_t(field.height))
        refuse("holds " + std::to_string(field.depths.size()) + " depths for " + std::to_string(field.width) + " x " +
               std::to_string(field.height) + " texels");
    for (const float depth : field.depths)
        if (!(depth >= 0 && depth <= 1))
            refuse("holds a depth of " + std::to_string(depth) + "; depths lie within [0, 1]");
}

/// Columns, rows and depths at the corners of cells.
BoundPlanes cells_of(const HeightField& field) {
    BoundPlanes bounds;
    bounds.width = field.width;
    bounds.height = field.height;
    bounds.wrap = field.wrap;
    const int outside = field.wrap == HeightWrap::clamp ? 1 : 0;
    bounds.columns = field.width + outside;
    bounds.rows = field.height + outside;
    bounds.depths.resize(std::size_t(bounds.columns + 1) * std::size_t(bounds.rows + 1));
    float* to = bounds.depths.data();
    for (int y = 0; y <= bounds.rows; ++y) {
        const int row = texel_index(y - outside, field.height, field.wrap);
        for (int x = 0; x <= bounds.columns; ++x)
            *to++ = field.depth(texel_index(x - outside, field.width, field.wrap), row);
    }
    return bounds;
}

void add_levels(BoundPlanes& bounds) {
    bounds.levels = {{bounds.columns, bounds.rows, 0}};
    std::size_t count = 0;
    for (int level = 1; bounds.levels.back().columns > 1 || bounds.levels.back().rows > 1; ++level) {
        const int side = 1 << level;
        const BoundLevel next{(bounds.columns + side - 1) / side, (bounds.rows + side - 1) / side, count};
        count += std::size_t(next.columns) * std::size_t(next.rows);
        bounds.levels.push_back(next);
    }
    bounds.planes.resize(count);
}

/// Corners of the cells of a node.
struct NodeCorners {
    const float* depths;
    int stride, columns, rows; ///< of corners
    double middle_u, middle_v; ///< from the first corner
};

struct Slopes {
    double u = 0, v = 0;
};

/// Least and greatest depth over a tilted plane through (middle, 0).
std::pair<double, double> range_over(const NodeCorners& node, Slopes slopes) {
    double least = std::numeric_limits<double>::infinity(), greatest = -least;
    for (int y = 0; y < node.rows; ++y) {
        const float* row = node.depths + std::ptrdiff_t(y) * node.stride;
        const double base = (y - node.middle_v) * slopes.v - node.middle_u * slopes.u;
        for (int x = 0; x < node.columns; ++x) {
            const double over = row[x] - (base + x * slopes.u);
            least = std::min(least, over);
            greatest = std::max(greatest, over);
        }
    }
    return {least, greatest};
}

/// The plane of least squares of the gap.
Slopes least_squares(const NodeCorners& node) {
    const double u0 = 0.5 * (node.columns - 1), v0 = 0.5 * (node.rows - 1);
    double du = 0, dv = 0;
    for (int y = 0; y < node.rows; ++y) {
        const float* row = node.depths + std::ptrdiff_t(y) * node.stride;
        double sum = 0, moment = 0;
        for (int x = 0; x < node.columns; ++x) {
            sum += row[x];
            moment += (x - u0) * row[x];
        }
        du += moment;
        dv += (y - v0) * sum;
    }
    const auto squares = [](double n) { return n * (n * n - 1) / 12; }; // Σ (x - x0)²
    return {du / (squares(node.columns) * node.rows), dv / (squares(node.rows) * node.columns)};
}

BoundPlane bound_of(const NodeCorners& node, int level) {
    const double unit = std::ldexp(1., -14 - level);
    const auto rounded = [&](double slope) {
        return std::int16_t(std::clamp(std::round(slope / unit), -32768., 32767.));
    };
    const Slopes wanted = least_squares(node);
    BoundPlane plane{rounded(wanted.u), rounded(wanted.v)};
    auto [least, greatest] = range_over(node, {plane.slope_u * unit, plane.slope_v * unit});
    const auto [flat, deepest] = range_over(node, {});
    if (least < flat) { // over the middle a level plane is the tighter one
        plane.slope_u = plane.slope_v = 0;
        least = flat;
        greatest = deepest;
    }
    plane.middle = std::uint16_t(std::clamp(std::floor(least * 65536), 0., 65535.));
    plane.thickness = std::uint16_t(std::min(std::ceil((greatest - plane.middle / 65536.) * 16384), 65535.));
    return plane;
}

/// All but the planes' values.
BoundPlanes unbounded(const HeightField& field) {
    check(field);
    BoundPlanes bounds = cells_of(field);
    add_levels(bounds);
    return bounds;
}

constexpr CheckedFileKind kStoredPlanes{
    {'K', 'o', 'B', 'o', 'u', 'n', 'd', 'P'}, 1, "relief bound planes", "another height field"};

std::uint64_t identity_of(const BoundPlanes& bounds) {
    FileIdentity identity;
    identity.add_value(bounds.width);
    identity.add_value(bounds.height);
    identity.add_value(int(bounds.wrap));
    identity.add(std::as_bytes(std::span(bounds.depths)));
    return identity.value();
}

} // namespace

BoundPlanes make_bound_planes(const HeightField& field) {
    BoundPlanes bounds = unbounded(field);
    for (std::size_t l = 1; l < bounds.levels.size(); ++l) {
        const BoundLevel& level = bounds.levels[l];
        BoundPlane* to = bounds.planes.data() + level.first;
        const int side = 1 << l;
        for (int j = 0; j < level.rows; ++j)
            for (int i = 0; i < level.columns; ++i) {
                const int x = i * side, y = j * side;
                *to++ = bound_of({bounds.depths.data() + std::size_t(y) * std::size_t(bounds.stride()) + x,
                                  bounds.stride(), std::min(side, bounds.columns - x) + 1,
                                  std::min(side, bounds.rows - y) + 1, 0.5 * side, 0.5 * side},
                                 int(l));
            }
    }
    return bounds;
}

void store_bound_planes(const BoundPlanes& bounds, const std::filesystem::path& path) {
    const std::array arrays{std::as_bytes(std::span(bounds.planes))};
    write_checked_file(path, kStoredPlanes, identity_of(bounds), arrays);
}

BoundPlanes load_bound_planes(const HeightField& field, const std::filesystem::path& path) {
    BoundPlanes bounds = unbounded(field);
    const CheckedFile file(path, kStoredPlanes, identity_of(bounds));
    std::vector<BoundPlane> planes = file.copied<BoundPlane>(0);
    if (planes.size() != bounds.planes.size())
        file.refuse_altered("it has " + std::to_string(planes.size()) + " planes, not " +
                            std::to_string(bounds.planes.size()));
    bounds.planes = std::move(planes);
    return bounds;
}

} // namespace kokage
