#include "common/services/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reflection/relief/cone_tracer.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "reflection/relief/cone_map.h"
#include "reflection/relief/cone_tracer.h"
#include "reflection/relief/lane_tracer.h"
#include "reflection/relief/ray_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kokage::relief_lanes::HWY_NAMESPACE {
namespace {

constexpr float kForever = std::numeric_limits<float>::infinity();
constexpr float kHair = 1e-6f; ///< of depth: what rounding may do to a ray's height over a cell's top

/// Lanes stand at t over a cell (column, row), which is tracked in whole numbers. A cone takes them to another cell;
/// lanes that dip below their cell's top wait until enough of them do, then read it.
template <bool kRepeat>
class ConeSteps {
  public:
    ConeSteps(const PaddedDepths& field, const CellCone* cones) : field_(field), cones_(cones) {
        t_ = column_ = row_ = per_dx_ = per_dy_ = waits_ = hn::Zero(Tag());
    }

    HWY_INLINE void Start(const Rays& rays, Mask starts) {
        const Vec zero = hn::Zero(Tag()), one = Constant(1);
        t_ = hn::IfThenElse(starts, zero, t_);
        column_ = hn::IfThenElse(starts, hn::Floor(rays.x), column_);
        row_ = hn::IfThenElse(starts, hn::Floor(rays.y), row_);
        per_dx_ = hn::IfThenElse(starts, hn::Div(one, rays.dx), per_dx_);
        per_dy_ = hn::IfThenElse(starts, hn::Div(one, rays.dy), per_dy_);
        waits_ = hn::IfThenElse(starts, zero, waits_);
    }

    HWY_INLINE Found Step(Rays& rays, Mask& hit, Mask& missed) {
        const Tag d;
        const Mask there = hn::RebindMask(d, hn::Gt(rays.ray, Whole(-1)));
        const Mask waiting = hn::And(there, hn::Gt(waits_, hn::Zero(d)));
        const std::size_t count = hn::CountTrue(d, waiting);
        if (count >= kCellBatch || count == hn::CountTrue(d, there))
            return ReadCells(rays, waiting, hit, missed);
        FollowCones(rays, hn::AndNot(waiting, there), missed);
        hit = hn::Gt(hn::Zero(d), hn::Zero(d)); // none
        return {t_, t_, t_, t_};
    }

  private:
    static constexpr std::size_t kCellBatch = std::max<std::size_t>(1, kLanes / 2);

    /// Where lanes leave their cells, or end.
    struct Exit {
        Vec t;
        Mask across_x;
    };

    HWY_INLINE Exit ExitOf(const Rays& rays) const {
        const Vec zero = hn::Zero(Tag()), one = Constant(1), never = Constant(kForever);
        const auto crossing = [&](Vec cell, Vec from, Vec direction, Vec per_direction) {
            const Vec border = hn::IfThenElse(hn::Gt(direction, zero), hn::Add(cell, one), cell);
            return hn::IfThenElse(hn::Eq(direction, zero), never, hn::Mul(hn::Sub(border, from), per_direction));
        };
        const Vec t_x = crossing(column_, rays.x, rays.dx, per_dx_), t_y = crossing(row_, rays.y, rays.dy, per_dy_);
        return {hn::Min(hn::Max(t_, hn::Min(t_x, t_y)), rays.t_last), hn::Le(t_x, t_y)};
    }

    /// Lanes of `leaving` to the next cell.
    HWY_INLINE void Leave(const Rays& rays, const Exit& exit, Mask leaving) {
        const Vec one = Constant(1);
        const Mask x = hn::And(leaving, exit.across_x), y = hn::AndNot(exit.across_x, leaving);
        column_ = hn::IfThenElse(x, hn::Add(column_, hn::CopySign(one, rays.dx)), column_);
        row_ = hn::IfThenElse(y, hn::Add(row_, hn::CopySign(one, rays.dy)), row_);
        t_ = hn::IfThenElse(leaving, exit.t, t_);
    }

    HWY_INLINE Place Cell() const {
        Place place;
        PlaceAlong<kRepeat>(column_, float(field_.width), place.column, place.a);
        PlaceAlong<kRepeat>(row_, float(field_.height), place.row, place.b);
        return place;
    }

    HWY_INLINE void FollowCones(Rays& rays, Mask on, Mask& missed) {
        const Vec zero = hn::Zero(Tag());
        const Int index = hn::IfThenElseZero(hn::RebindMask(IntTag(), on), IndexOf(Cell(), field_.width));
        Vec top, ratio;
        GatherPairs(&cones_->top, hn::Add(index, index), top, ratio);
        rays.reads = hn::Add(rays.reads, hn::IfThenElseZero(hn::RebindMask(IntTag(), on), Whole(1)));

        const Exit exit = ExitOf(rays);
        const Vec z = hn::MulAdd(t_, rays.ddepth, rays.depth), z_out = hn::MulAdd(exit.t, rays.ddepth, rays.depth);
        const Vec ceiling = hn::Sub(top, Constant(kHair)), gap = hn::Sub(ceiling, z);
        // Within the cone for as long as speed s <= ratio (gap - ddepth s).
        const Vec speed = hn::Add(hn::Abs(rays.dx), hn::Abs(rays.dy)), closing = hn::MulAdd(ratio, rays.ddepth, speed);
        const Vec way =
            hn::IfThenElse(hn::Gt(closing, zero), hn::Div(hn::Mul(ratio, gap), closing), Constant(kForever));
        const Vec t_cone = hn::Min(hn::MulAdd(way, Constant(0.9999f), t_), rays.t_last);
        const Mask above = hn::And(on, hn::Gt(gap, zero));
        const Mask jumps = hn::And(above, hn::Or(hn::Gt(t_cone, exit.t), hn::Ge(t_cone, rays.t_last)));
        const Mask passes = hn::AndNot(jumps, hn::And(above, hn::Lt(z_out, ceiling)));
        missed = hn::And(hn::Or(jumps, passes), hn::Ge(hn::IfThenElse(jumps, t_cone, exit.t), rays.t_last));
        Leave(rays, exit, passes);
        const auto land = [&](Vec& cell, Vec from, Vec direction) {
            const Vec at = hn::Floor(hn::MulAdd(t_cone, direction, from));
            const Vec onwards = hn::IfThenElse(hn::Ge(direction, zero), hn::Max(at, cell), hn::Min(at, cell));
            cell = hn::IfThenElse(jumps, onwards, cell);
        };
        land(column_, rays.x, rays.dx);
        land(row_, rays.y, rays.dy);
        t_ = hn::IfThenElse(jumps, t_cone, t_);
        waits_ = hn::IfThenElse(hn::AndNot(hn::Or(jumps, passes), on), Constant(1), waits_);
    }

    /// The first root in the bilinear cell, as cell_by_cell.cpp's.
    HWY_INLINE Found ReadCells(Rays& rays, Mask on, Mask& hit, Mask& missed) {
        const Vec zero = hn::Zero(Tag()), one = Constant(1), never = Constant(kForever);
        rays.reads = hn::Add(rays.reads, hn::IfThenElseZero(hn::RebindMask(IntTag(), on), Whole(1)));
        const Exit exit = ExitOf(rays);
        Cells cells = CellsAt(field_, Cell());
        if constexpr (!kRepeat) { // before the first texel the border goes on level
            const Mask left = hn::Lt(column_, zero), up = hn::Lt(row_, zero);
            cells.du = hn::IfThenZeroElse(left, cells.du);
            cells.dv = hn::IfThenZeroElse(up, cells.dv);
            cells.duv = hn::IfThenZeroElse(hn::Or(left, up), cells.duv);
        }
        const Vec x = hn::MulAdd(t_, rays.dx, hn::Sub(rays.x, column_)),
                  y = hn::MulAdd(t_, rays.dy, hn::Sub(rays.y, row_));
        const Vec a = hn::Neg(hn::Mul(cells.duv, hn::Mul(rays.dx, rays.dy)));
        const Vec b = hn::NegMulAdd(cells.slope_a(y), rays.dx, hn::NegMulAdd(cells.slope_b(x), rays.dy, rays.ddepth));
        const Vec c = hn::Sub(hn::MulAdd(t_, rays.ddepth, rays.depth), cells.depth(x, y));
        const Vec length = hn::Sub(exit.t, t_);
        const Vec discriminant = hn::NegMulAdd(hn::Mul(Constant(4), a), c, hn::Mul(b, b));
        const Vec sum = hn::Mul(Constant(-0.5f), hn::Add(b, hn::CopySign(hn::Sqrt(hn::Max(discriminant, zero)), b)));
        const auto taken = [&](Vec root, Mask valid) {
            valid = hn::And(valid, hn::And(hn::Ge(root, zero), hn::Le(root, length)));
            return hn::IfThenElse(valid, root, never);
        };
        const Mask real = hn::Ge(discriminant, zero);
        Vec s = hn::Min(taken(hn::Div(sum, a), hn::And(real, hn::Ne(a, zero))),
                        taken(hn::Div(c, sum), hn::And(real, hn::Ne(sum, zero))));
        const Vec at_end = hn::MulAdd(length, hn::MulAdd(length, a, b), c);
        s = hn::Min(s, hn::IfThenElse(hn::Ge(at_end, zero), length, never));
        s = hn::IfThenElse(hn::Ge(c, zero), zero, s);
        hit = hn::And(on, hn::Lt(s, never));
        const Mask leaves = hn::AndNot(hit, on);
        missed = hn::And(leaves, hn::Ge(exit.t, rays.t_last));
        const auto inside = [&](Vec at) { return hn::Max(zero, hn::Min(at, one)); };
        s = hn::IfThenElseZero(hit, s);
        const Vec u = inside(hn::MulAdd(s, rays.dx, x)), v = inside(hn::MulAdd(s, rays.dy, y));
        const Found found{hn::Add(t_, s), cells.depth(u, v), cells.slope_a(v), cells.slope_b(u)};
        Leave(rays, exit, leaves);
        waits_ = hn::IfThenZeroElse(on, waits_);
        return found;
    }

    const PaddedDepths& field_;
    const CellCone* cones_;
    Vec t_;
    Vec column_, row_;    ///< the cell; not wrapped
    Vec per_dx_, per_dy_; ///< 1 / dx, 1 / dy
    Vec waits_;           ///< 1: to read its cell
};

} // namespace

void TraceCones(const PaddedDepths& field, const CellCone* cones, std::span<const ReliefRay> rays,
                const LaneResults& results) {
    if (field.wrap == HeightWrap::repeat)
        RayStream<true, ConeSteps<true>>(field, rays, results, {field, cones}).run();
    else
        RayStream<false, ConeSteps<false>>(field, rays, results, {field, cones}).run();
}

} // namespace kokage::relief_lanes::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kokage {
namespace relief_lanes {

HWY_EXPORT(TraceCones);

} // namespace relief_lanes

namespace {

class CellConeTracer final : public LaneTracer<ConeTracer> {
  public:
    explicit CellConeTracer(const HeightField& field)
        : LaneTracer(field), padded_(field), cones_(make_cone_map(field)) {}
    CellConeTracer(const HeightField& field, const std::filesystem::path& path)
        : LaneTracer(field), padded_(field), cones_(load_cone_map(field, path)) {}

    std::size_t bytes() const override { return padded_.bytes() + cones_.size() * sizeof(CellCone); }
    void store(const std::filesystem::path& path) const override { store_cone_map(field_, cones_, path); }

  private:
    void search(std::span<const ReliefRay> rays, const LaneResults& results) const override {
        using namespace relief_lanes;
        HWY_DYNAMIC_DISPATCH(TraceCones)(padded_, cones_.data(), rays, results);
    }

    PaddedDepths padded_; // checks the field before cones are made of it
    std::vector<CellCone> cones_;
};

} // namespace

std::unique_ptr<ConeTracer> make_cone_tracer(const HeightField& field) {
    return std::make_unique<CellConeTracer>(field);
}

std::unique_ptr<ConeTracer> load_cone_tracer(const HeightField& field, const std::filesystem::path& path) {
    return std::make_unique<CellConeTracer>(field, path);
}

} // namespace kokage
#endif
