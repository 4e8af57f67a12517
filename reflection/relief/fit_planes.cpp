#include "common/services/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reflection/relief/fit_planes.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "reflection/relief/fit_planes.h"
#include "reflection/relief/lane_vectors-inl.h"

#include <algorithm>
#include <cmath>
#include <limits>

// Slopes by least squares, then shifted until no corner of a cell lies above. (The plane that is highest over the
// middle, the face of the corners' lower hull there, is no better: it saves reads where rays pass but is thicker where
// they dive. Half of each saves 2 to 4 % of reads at twice the time.)
//
// Nodes of up to 8 x 8 cells take all corners of cells for points, 16 nodes side by side. Greater ones take the planes
// of the nodes two levels below, at those nodes' corners; then the surface itself tells by how much to shift.
HWY_BEFORE_NAMESPACE();
namespace kokage::HWY_NAMESPACE {
namespace {

using namespace relief_lanes::HWY_NAMESPACE;

constexpr float kRounding = 0x1p-21f; ///< more than what depths over a plane lose to rounding
constexpr int kAllPointsLevel = 3;    ///< up to here all corners of cells are points
constexpr int kMostPoints = 81;

/// Points in a square grid around the middle, with a depth in every lane.
struct Points {
    int side = 0;      ///< points along an axis
    float spacing = 0; ///< texels
    HWY_ALIGN float depth[kMostPoints][kLanes];

    HWY_INLINE float offset(int k) const { return (float(k) - 0.5f * float(side - 1)) * spacing; }
    HWY_INLINE Vec at(int x, int y) const { return hn::Load(Tag(), depth[y * side + x]); }
};

/// Slopes as they are stored, and as numbers.
struct Slopes {
    Int u, v;
    Vec slope_u, slope_v;
};

HWY_INLINE Slopes Rounded(Vec slope_u, Vec slope_v, float unit) {
    const auto rounded = [&](Vec slope) {
        const Vec units = hn::Mul(slope, Constant(1 / unit));
        return hn::NearestInt(hn::Min(hn::Max(units, Constant(-32768)), Constant(32767)));
    };
    const Int u = rounded(slope_u), v = rounded(slope_v);
    return {u, v, hn::Mul(hn::ConvertTo(Tag(), u), Constant(unit)), hn::Mul(hn::ConvertTo(Tag(), v), Constant(unit))};
}

HWY_INLINE Slopes LeastSquares(const Points& points, float unit) {
    Vec along_u = hn::Zero(Tag()), along_v = along_u;
    float squares = 0;
    for (int y = 0; y < points.side; ++y) {
        squares += points.offset(y) * points.offset(y);
        for (int x = 0; x < points.side; ++x) {
            along_u = hn::MulAdd(Constant(points.offset(x)), points.at(x, y), along_u);
            along_v = hn::MulAdd(Constant(points.offset(y)), points.at(x, y), along_v);
        }
    }
    const Vec share = Constant(1 / (squares * float(points.side)));
    return Rounded(hn::Mul(along_u, share), hn::Mul(along_v, share), unit);
}

struct Range {
    Vec least, greatest; ///< depth over the plane
};

HWY_INLINE Range RangeOver(const Points& points, Vec slope_u, Vec slope_v) {
    Range range{Constant(std::numeric_limits<float>::max()), Constant(std::numeric_limits<float>::lowest())};
    for (int y = 0; y < points.side; ++y) {
        const Vec base = hn::Mul(Constant(points.offset(y)), slope_v);
        for (int x = 0; x < points.side; ++x) {
            const Vec over = hn::Sub(points.at(x, y), hn::MulAdd(Constant(points.offset(x)), slope_u, base));
            range.least = hn::Min(range.least, over);
            range.greatest = hn::Max(range.greatest, over);
        }
    }
    return range;
}

/// Over corners of cells in rows, of one node.
struct Corners {
    const float* depths;
    int stride, columns, rows;
    float middle_u, middle_v; ///< from the first corner
};

struct ScalarRange {
    float least, greatest;
};

ScalarRange RangeOver(const Corners& corners, float slope_u, float slope_v) {
    const Tag d;
    const int step = int(hn::Lanes(d));
    Vec least = Constant(std::numeric_limits<float>::max()), greatest = Constant(std::numeric_limits<float>::lowest());
    const Vec slope = Constant(slope_u), lane = hn::Iota(d, -corners.middle_u);
    for (int y = 0; y < corners.rows; ++y) {
        const float* row = corners.depths + std::ptrdiff_t(y) * corners.stride;
        const Vec base = Constant((float(y) - corners.middle_v) * slope_v);
        const auto take = [&](Vec depth, int x) {
            const Vec over = hn::Sub(depth, hn::MulAdd(hn::Add(lane, Constant(float(x))), slope, base));
            least = hn::Min(least, over);
            greatest = hn::Max(greatest, over);
        };
        int x = 0;
        for (; x + step <= corners.columns; x += step)
            take(hn::LoadU(d, row + x), x);
        if (x < corners.columns && corners.columns >= step) {
            take(hn::LoadU(d, row + corners.columns - step), corners.columns - step);
        } else if (x < corners.columns) {
            HWY_ALIGN float few[kLanes];
            for (int k = 0; k < step; ++k) // the last one again and again, in its place
                few[k] = row[std::min(k, corners.columns - 1)];
            const Vec place = hn::Min(hn::Iota(d, 0), Constant(float(corners.columns - 1)));
            const Vec over =
                hn::Sub(hn::Load(d, few), hn::MulAdd(hn::Sub(place, Constant(corners.middle_u)), slope, base));
            least = hn::Min(least, over);
            greatest = hn::Max(greatest, over);
        }
    }
    return {hn::GetLane(hn::MinOfLanes(d, least)), hn::GetLane(hn::MaxOfLanes(d, greatest))};
}

BoundPlane Stored(int slope_u, int slope_v, ScalarRange range) {
    const float rounding = slope_u || slope_v ? kRounding : 0; // a level plane loses nothing
    BoundPlane plane{std::int16_t(slope_u), std::int16_t(slope_v)};
    plane.middle = std::uint16_t(std::clamp(std::floor((range.least - rounding) * 65536), 0.f, 65535.f));
    const float deepest = range.greatest + rounding - float(plane.middle) * 0x1p-16f;
    plane.thickness = std::uint16_t(std::min(std::ceil(deepest * 16384), 65535.f));
    return plane;
}

/// The tilted plane, or a level one where that is no less deep over the node's middle, `beside` the place that planes
/// are stored for, or where the tilted one can't be stored.
BoundPlane Better(int slope_u, int slope_v, ScalarRange tilted, ScalarRange flat, float beside = 0) {
    const bool tilts = tilted.least + beside > flat.least && tilted.least > 0x1p-15f && tilted.least < 1;
    return tilts ? Stored(slope_u, slope_v, tilted) : Stored(0, 0, flat);
}

class Fitter {
  public:
    explicit Fitter(BoundPlanes& bounds) : bounds_(bounds) {}

    void fit(int level) {
        const BoundLevel& nodes = bounds_.levels[std::size_t(level)];
        const int side = 1 << level, whole_columns = bounds_.columns / side, whole_rows = bounds_.rows / side;
        BoundPlane* to = bounds_.planes.data() + nodes.first;
        for (int row = 0; row < nodes.rows; ++row, to += nodes.columns) {
            int column = 0;
            if (row < whole_rows)
                for (; column < whole_columns; column += int(kLanes))
                    FitWhole(level, column, whole_columns, row, to);
            for (column = row < whole_rows ? whole_columns : 0; column < nodes.columns; ++column)
                to[column] = FitClipped(CornersOf(level, column, row), level);
        }
    }

  private:
    Corners CornersOf(int level, int column, int row) const {
        const int side = 1 << level, x = column * side, y = row * side;
        return {bounds_.depths.data() + std::size_t(y) * std::size_t(bounds_.stride()) + std::size_t(x),
                bounds_.stride(),
                std::min(side, bounds_.columns - x) + 1,
                std::min(side, bounds_.rows - y) + 1,
                0.5f * float(side),
                0.5f * float(side)};
    }

    /// Up to kLanes nodes from `first` to before `end` that no border clips.
    void FitWhole(int level, int first, int end, int row, BoundPlane* to) {
        const Tag d;
        const IntTag di;
        const Int column = hn::Min(hn::Iota(di, first), hn::Set(di, end - 1));
        const bool all = level <= kAllPointsLevel;
        if (all)
            LoadCorners(level, column, row);
        else
            LoadPlanes(level, column, row);
        const float unit = std::ldexp(1.f, -14 - level);
        const Slopes slopes = LeastSquares(points_, unit);
        HWY_ALIGN int slope_u[kLanes], slope_v[kLanes];
        hn::Store(slopes.u, di, slope_u);
        hn::Store(slopes.v, di, slope_v);
        HWY_ALIGN float least[kLanes], greatest[kLanes], flat[kLanes], deepest[kLanes];
        if (all) {
            const Range tilted = RangeOver(points_, slopes.slope_u, slopes.slope_v),
                        plain = RangeOver(points_, hn::Zero(d), hn::Zero(d));
            hn::Store(tilted.least, d, least);
            hn::Store(tilted.greatest, d, greatest);
            hn::Store(plain.least, d, flat);
            hn::Store(plain.greatest, d, deepest);
        }
        for (int k = 0; k < int(kLanes) && first + k < end; ++k) {
            ScalarRange tilted, plain;
            if (all) {
                tilted = {least[k], greatest[k]};
                plain = {flat[k], deepest[k]};
            } else {
                const Corners corners = CornersOf(level, first + k, row);
                tilted = RangeOver(corners, float(slope_u[k]) * unit, float(slope_v[k]) * unit);
                plain = RangeOver(corners, 0, 0);
            }
            to[first + k] = Better(slope_u[k], slope_v[k], tilted, plain);
        }
    }

    HWY_INLINE void LoadCorners(int level, Int column, int row) {
        const Tag d;
        const int side = 1 << level;
        points_.side = side + 1;
        points_.spacing = 1;
        const Int place = hn::ShiftLeftSame(column, level);
        for (int y = 0; y <= side; ++y) {
            const float* from = bounds_.depths.data() + std::size_t(row * side + y) * std::size_t(bounds_.stride());
            for (int x = 0; x <= side; ++x)
                hn::Store(hn::GatherIndex(d, from + x, place), d, points_.depth[y * points_.side + x]);
        }
    }

    /// 5 x 5 corners of the 4 x 4 nodes two levels below; where they meet, the one least deep.
    HWY_INLINE void LoadPlanes(int level, Int column, int row) {
        const Tag d;
        const IntTag di;
        points_.side = 5;
        points_.spacing = std::ldexp(1.f, level - 2);
        for (int k = 0; k < 25; ++k)
            hn::Store(Constant(std::numeric_limits<float>::max()), d, points_.depth[k]);
        const BoundLevel& below = bounds_.levels[std::size_t(level - 2)];
        const Vec half = Constant(std::ldexp(1.f, -14 - (level - 2)) * 0.5f * points_.spacing);
        for (int y = 0; y < 4; ++y)
            for (int x = 0; x < 4; ++x) {
                const int* from = reinterpret_cast<const int*>(bounds_.planes.data() + below.first +
                                                               std::size_t(row * 4 + y) * std::size_t(below.columns) +
                                                               std::size_t(x));
                const Int place = hn::ShiftLeft<3>(column); // 4 nodes of two ints
                const Int slopes = hn::GatherIndex(di, from, place), depths = hn::GatherIndex(di, from + 1, place);
                const Vec u = hn::Mul(hn::ConvertTo(d, hn::ShiftRight<16>(hn::ShiftLeft<16>(slopes))), half),
                          v = hn::Mul(hn::ConvertTo(d, hn::ShiftRight<16>(slopes)), half),
                          middle = hn::Mul(hn::ConvertTo(d, hn::And(depths, hn::Set(di, 0xffff))), Constant(0x1p-16f));
                for (int corner = 0; corner < 4; ++corner) {
                    const int at_x = x + (corner & 1), at_y = y + corner / 2;
                    const Vec along = hn::Add(corner & 1 ? u : hn::Neg(u), corner & 2 ? v : hn::Neg(v));
                    float* slot = points_.depth[at_y * 5 + at_x];
                    hn::Store(hn::Min(hn::Load(d, slot), hn::Add(middle, along)), d, slot);
                }
            }
    }

    /// A node at the border: the plane of least squares.
    static BoundPlane FitClipped(const Corners& corners, int level) {
        double along_u = 0, along_v = 0;
        const double u0 = 0.5 * (corners.columns - 1), v0 = 0.5 * (corners.rows - 1);
        for (int y = 0; y < corners.rows; ++y) {
            const float* row = corners.depths + std::ptrdiff_t(y) * corners.stride;
            float sum = 0, moment = 0;
            for (int x = 0; x < corners.columns; ++x) {
                sum += row[x];
                moment += (float(x) - float(u0)) * row[x];
            }
            along_u += double(moment);
            along_v += (y - v0) * double(sum);
        }
        const auto squares = [](double n) { return n * (n * n - 1) / 12; }; // Σ (x - x0)²
        const float unit = std::ldexp(1.f, -14 - level);
        const auto rounded = [&](double slope) {
            return int(std::clamp(std::round(slope / double(unit)), -32768., 32767.));
        };
        const int slope_u = rounded(along_u / (squares(corners.columns) * corners.rows)),
                  slope_v = rounded(along_v / (squares(corners.rows) * corners.columns));
        const ScalarRange tilted = RangeOver(corners, float(slope_u) * unit, float(slope_v) * unit),
                          plain = RangeOver(corners, 0, 0);
        return Better(slope_u, slope_v, tilted, plain,
                      (float(u0) - corners.middle_u) * float(slope_u) * unit +
                          (float(v0) - corners.middle_v) * float(slope_v) * unit);
    }

    BoundPlanes& bounds_;
    Points points_;
};

} // namespace

void FitPlanes(BoundPlanes& bounds) {
    Fitter fitter(bounds);
    for (int level = 1; level < int(bounds.levels.size()); ++level)
        fitter.fit(level);
}

} // namespace kokage::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kokage {

HWY_EXPORT(FitPlanes);

void fit_planes(BoundPlanes& bounds) {
    HWY_DYNAMIC_DISPATCH(FitPlanes)(bounds);
}

} // namespace kokage
#endif
