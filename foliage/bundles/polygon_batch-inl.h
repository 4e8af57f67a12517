// As many polygons as a vector has lanes, projected and turned into pixels together: the inner part of line_raster.cpp.
// Per-target code of Google Highway: included once for every instruction set, so the guard toggles.
#include "foliage/bundles/line_raster.h"

#include <hwy/highway.h>

#include <bit>

#if defined(KOKAGE_POLYGON_BATCH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KOKAGE_POLYGON_BATCH_INL_H
#undef KOKAGE_POLYGON_BATCH_INL_H
#else
#define KOKAGE_POLYGON_BATCH_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace kokage::bundles::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::ScalableTag<float>;
using IntTag = hn::RebindToSigned<FloatTag>;
using KeyTag = hn::RebindToUnsigned<FloatTag>;
using FloatVec = hn::Vec<FloatTag>;
using IntVec = hn::Vec<IntTag>;
using KeyVec = hn::Vec<KeyTag>;
using FloatMask = hn::Mask<FloatTag>;

constexpr std::size_t kMostLanes = HWY_MAX_BYTES / 4;
/// Polygons of more rows or columns than this are drawn row by row: waiting for them would stall the others.
/// Cards with holes are all large.
constexpr int kMostBatchRows = 32, kMostBatchColumns = 32, kMostMaskedRows = 64, kMostMaskedColumns = 64;
/// Polygons this close to edge-on are not drawn: they hold a hundred-thousandth of the light, and their depth is too
/// steep.
constexpr float kLeastFacing = 0.004f;

struct DepthScale {
    float low, scale; ///< half the quantised depth's fixed-point value = (depth - low) * scale
};

/// Covered pixels, not in any order: index in the picture, and key.
struct FragmentBuffer {
    std::uint32_t *pixel, *key;
    std::size_t count = 0;
};

/// Keys are a plane over the picture in fixed point, depth in the bits above the face's:
/// key(x, y) = (key0 + (x - first_column) key_du + (y - first_row) key_dv) without its low bits | face.
/// Arithmetic wraps, the result doesn't.
template <int Corners>
struct PolygonBatch {
    FloatVec u0, v0;                         ///< corner 0, pixels
    FloatVec base[Corners], slope[Corners];  ///< lines of the edges, u = base + slope v
    FloatMask left[Corners], right[Corners]; ///< on which side the edge lies; level edges on neither
    FloatVec first_row, rows, first_column, columns;
    FloatVec facing, slope_u, slope_v; ///< depth over the picture: a plane
    KeyVec key0, key_du, key_dv, face;
    FloatMask alive; ///< lanes that cover a row and a column of pixel centres and don't stand on edge
};

/// Projects polygons [first, first + lanes) of a group, throws out those that can't cover a pixel, sets up edges and
/// depths. False if none is left.
template <int Corners>
HWY_INLINE bool ProjectBatch(const PolygonGroup& group, std::size_t first, const Projection& projection,
                             DepthScale depths, PolygonBatch<Corners>& batch) {
    const FloatTag d;
    const IntTag di;
    const KeyTag dk;
    const float density = projection.pixels_per_unit;
    const glm::vec3 ua = projection.u_axis * density, va = projection.v_axis * density,
                    wa = projection.direction * density;
    const auto dot = [&](const glm::vec3& axis, auto x, auto y, auto z) {
        return hn::MulAdd(x, hn::Set(d, axis.x), hn::MulAdd(y, hn::Set(d, axis.y), hn::Mul(z, hn::Set(d, axis.z))));
    };
    FloatVec u[Corners], v[Corners];
    auto low_u = hn::Set(d, 1e30f), high_u = hn::Set(d, -1e30f), low_v = low_u, high_v = high_u, depth = hn::Zero(d);
    for (int k = 0; k < Corners; ++k) {
        const auto c = std::size_t(k);
        const auto x = hn::LoadU(d, &group.x[c][first]), y = hn::LoadU(d, &group.y[c][first]),
                   z = hn::LoadU(d, &group.z[c][first]);
        u[k] = hn::Add(dot(ua, x, y, z), hn::Set(d, projection.offset.x));
        v[k] = hn::Add(dot(va, x, y, z), hn::Set(d, projection.offset.y));
        low_u = hn::Min(low_u, u[k]);
        high_u = hn::Max(high_u, u[k]);
        low_v = hn::Min(low_v, v[k]);
        high_v = hn::Max(high_v, v[k]);
        if (k == 0)
            depth = dot(wa, x, y, z);
    }
    batch.first_row = hn::Ceil(low_v);
    batch.rows = hn::Sub(hn::Ceil(high_v), batch.first_row);
    batch.first_column = hn::Ceil(low_u);
    batch.columns = hn::Sub(hn::Ceil(high_u), batch.first_column);
    batch.alive = hn::And(hn::Gt(batch.rows, hn::Zero(d)), hn::Gt(batch.columns, hn::Zero(d)));
    batch.alive = hn::And(batch.alive, hn::FirstN(d, group.count - first));
    if (hn::AllFalse(d, batch.alive))
        return false;
    const auto nx = hn::LoadU(d, &group.normal_x[first]), ny = hn::LoadU(d, &group.normal_y[first]),
               nz = hn::LoadU(d, &group.normal_z[first]);
    batch.facing = dot(projection.direction, nx, ny, nz);
    batch.alive = hn::And(batch.alive, hn::Gt(hn::Abs(batch.facing), hn::Set(d, kLeastFacing)));
    if (hn::AllFalse(d, batch.alive))
        return false;
    batch.u0 = u[0];
    batch.v0 = v[0];
    // The face of bark that looks to the far end is the next one.
    const auto far_bark = hn::And(hn::Gt(batch.facing, hn::Zero(d)), batch.alive);
    const auto face = hn::LoadU(dk, &group.face[first]);
    batch.face = hn::Add(hn::And(face, hn::Set(dk, ~PolygonGroup::kBark)),
                         hn::IfThenElseZero(hn::RebindMask(dk, far_bark), hn::ShiftRight<31>(face)));

    // The plane n . (p - p0) = 0 as depth over the picture.
    const auto inverse = hn::Div(hn::Set(d, -1.f), hn::IfThenElse(batch.alive, batch.facing, hn::Set(d, 1.f)));
    batch.slope_u = hn::Mul(dot(projection.u_axis, nx, ny, nz), inverse);
    batch.slope_v = hn::Mul(dot(projection.v_axis, nx, ny, nz), inverse);
    const auto to_first = hn::MulAdd(hn::Sub(batch.first_column, u[0]), batch.slope_u,
                                     hn::Mul(hn::Sub(batch.first_row, v[0]), batch.slope_v));
    const auto scale = hn::Set(d, depths.scale);
    // At the corner of a steep polygon's box the plane lies far outside the depths, and a conversion would saturate.
    // Whole turns are taken off first: keys wrap, so the pixels that are covered get their own depths all the same.
    const auto fixed = [&](auto value) {
        const auto half = hn::Mul(value, scale), turns = hn::Round(hn::Mul(half, hn::Set(d, 0x1p-31f)));
        const auto wrapped = hn::NegMulAdd(turns, hn::Set(d, 0x1p31f), half);
        return hn::ShiftLeft<1>(hn::BitCast(dk, hn::ConvertTo(di, wrapped)));
    };
    batch.key0 = fixed(hn::Add(hn::Sub(depth, hn::Set(d, depths.low)), to_first));
    batch.key_du = fixed(batch.slope_u);
    batch.key_dv = fixed(batch.slope_v);

    // Counter-clockwise seen from the near end when facing < 0: then edges that rise in v are on the right.
    const auto turned = hn::Lt(batch.facing, hn::Zero(d));
    for (int k = 0, j = Corners - 1; k < Corners; j = k++) {
        const auto dv = hn::Sub(v[k], v[j]);
        batch.slope[k] = hn::Div(hn::Sub(u[k], u[j]), dv);
        batch.base[k] = hn::NegMulAdd(v[j], batch.slope[k], u[j]);
        const auto rising = hn::Gt(dv, hn::Zero(d)), falling = hn::Lt(dv, hn::Zero(d));
        batch.right[k] = hn::Or(hn::And(rising, turned), hn::AndNot(turned, falling));
        batch.left[k] = hn::Or(hn::And(falling, turned), hn::AndNot(turned, rising));
    }
    return true;
}

/// No mask: every covered pixel is solid.
struct NoHoles {
    static constexpr bool kMasked = false;
    void StartRow(FloatVec, FloatVec) {}
    void NextColumn() {}
    HWY_INLINE FloatMask Solid(FloatMask inside) const { return inside; }
};

/// The masks of a batch's polygons over the picture: texel coordinates are planes over it, as depth is. Only for
/// polygons that stay in their texture.
class HolesOfBatch {
  public:
    static constexpr bool kMasked = true;

    /// Of polygons [first, first + lanes); those that aren't `drawn` need not make sense.
    template <int Corners>
    HolesOfBatch(const PolygonGroup& group, std::size_t first, const MaskBits& bits, const Projection& projection,
                 const PolygonBatch<Corners>& batch, FloatMask drawn)
        : words_(reinterpret_cast<const std::int32_t*>(bits.words.data())) {
        const FloatTag d;
        const IntTag di;
        const float pixel = 1 / projection.pixels_per_unit;
        const glm::vec3 &u = projection.u_axis, &v = projection.v_axis, &w = projection.direction;
        for (std::size_t axis = 0; axis < 2; ++axis) {
            const auto gx = hn::LoadU(d, &group.texels.gradient[axis][0][first]),
                       gy = hn::LoadU(d, &group.texels.gradient[axis][1][first]),
                       gz = hn::LoadU(d, &group.texels.gradient[axis][2][first]);
            const auto along = [&](const glm::vec3& a) {
                return hn::Mul(
                    hn::MulAdd(gx, hn::Set(d, a.x), hn::MulAdd(gy, hn::Set(d, a.y), hn::Mul(gz, hn::Set(d, a.z)))),
                    hn::Set(d, pixel));
            };
            // Moving a pixel moves along the plane, (u_axis + direction slope_u) / density.
            const auto along_w = along(w);
            const auto du = hn::MulAdd(along_w, batch.slope_u, along(u)),
                       dv = hn::MulAdd(along_w, batch.slope_v, along(v));
            const auto corner = hn::LoadU(d, &group.texels.at_corner[axis][first]);
            const auto origin = hn::NegMulAdd(batch.u0, du, hn::NegMulAdd(batch.v0, dv, corner));
            du_[axis] = hn::IfThenElseZero(drawn, du);
            dv_[axis] = hn::IfThenElseZero(drawn, dv);
            origin_[axis] = hn::IfThenElseZero(drawn, origin);
            texel_[axis] = origin_[axis];
        }
        const auto mask = hn::LoadU(di, &group.texels.mask[first]);
        first_ = hn::GatherIndex(di, bits.first.data(), mask);
        stride_ = hn::GatherIndex(di, bits.stride.data(), mask);
        last_[0] = hn::GatherIndex(d, bits.last_column.data(), mask);
        last_[1] = hn::GatherIndex(d, bits.last_row.data(), mask);
    }

    HWY_INLINE void StartRow(FloatVec x, FloatVec y) {
        for (std::size_t axis = 0; axis < 2; ++axis)
            texel_[axis] = hn::MulAdd(x, du_[axis], hn::MulAdd(y, dv_[axis], origin_[axis]));
    }
    HWY_INLINE void NextColumn() {
        for (std::size_t axis = 0; axis < 2; ++axis)
            texel_[axis] = hn::Add(texel_[axis], du_[axis]);
    }
    /// Those of the lanes `inside` whose texel is solid.
    HWY_INLINE FloatMask Solid(FloatMask inside) const {
        const FloatTag d;
        const IntTag di;
        const auto clamped = [&](std::size_t axis) {
            return hn::ConvertTo(di, hn::Min(hn::Max(texel_[axis], hn::Zero(d)), last_[axis]));
        };
        const auto column = clamped(0), row = clamped(1);
        const auto place = hn::Add(hn::Add(first_, hn::Mul(row, stride_)), hn::ShiftRight<5>(column));
        const auto word = hn::GatherIndex(di, words_, place);
        const auto bit = hn::Shl(hn::Set(di, 1), hn::And(column, hn::Set(di, 31)));
        return hn::And(inside, hn::RebindMask(d, hn::TestBit(word, bit)));
    }

  private:
    const std::int32_t* words_;
    FloatVec du_[2], dv_[2], origin_[2], texel_[2], last_[2];
    IntVec first_, stride_;
};

/// Adds the covered pixels of the lanes in `drawn` that are solid to the buffer, and their number to `fragments` of
/// their face.
template <int Corners, class Holes>
HWY_INLINE void DrawBatch(const PolygonBatch<Corners>& batch, FloatMask drawn, Holes holes,
                          const Projection& projection, std::uint32_t face_mask, FragmentBuffer& buffer,
                          std::uint32_t* fragments) {
    const FloatTag d;
    const IntTag di;
    const KeyTag dk;
    const auto rows = hn::IfThenElseZero(drawn, batch.rows);
    const int most_rows = int(hn::GetLane(hn::MaxOfLanes(d, rows)));
    const auto first_column = hn::ConvertTo(di, batch.first_column);
    auto line = hn::Mul(hn::ConvertTo(di, batch.first_row), hn::Set(di, projection.width));
    auto line_key = batch.key0;
    auto y = batch.first_row;
    auto covered = hn::Zero(d);
    std::uint32_t *pixel_out = buffer.pixel + buffer.count, *key_out = buffer.key + buffer.count;
    for (int row = 0; row < most_rows; ++row) {
        // Clamped to the picture, so that rounding at nearly level edges can never leave it.
        auto left = hn::Zero(d), right = hn::Set(d, float(projection.width));
        for (int k = 0; k < Corners; ++k) {
            const auto u = hn::MulAdd(y, batch.slope[k], batch.base[k]);
            left = hn::IfThenElse(batch.left[k], hn::Max(left, u), left);
            right = hn::IfThenElse(batch.right[k], hn::Min(right, u), right);
        }
        const auto begin = hn::Ceil(left);
        auto remaining = hn::Sub(hn::Ceil(right), begin);
        auto inside = hn::And(hn::Lt(hn::Set(d, float(row)), rows), hn::Gt(remaining, hn::Zero(d)));
        if (!hn::AllFalse(d, inside)) {
            if constexpr (!Holes::kMasked)
                covered = hn::Add(covered, hn::IfThenElseZero(inside, remaining));
            holes.StartRow(begin, y);
            const auto column = hn::ConvertTo(di, begin);
            auto pixel = hn::BitCast(dk, hn::Add(line, column));
            auto key = hn::Add(line_key, hn::Mul(hn::BitCast(dk, hn::Sub(column, first_column)), batch.key_du));
            do {
                const auto solid = holes.Solid(inside);
                if constexpr (Holes::kMasked)
                    covered = hn::Add(covered, hn::IfThenElseZero(solid, hn::Set(d, 1.f)));
                const auto lanes = hn::RebindMask(dk, solid);
                const auto faced = hn::Or(hn::AndNot(hn::Set(dk, face_mask), key), batch.face);
                hn::StoreU(hn::Compress(faced, lanes), dk, key_out);
                hn::StoreU(hn::Compress(pixel, lanes), dk, pixel_out);
                const std::size_t written = hn::CountTrue(dk, lanes);
                key_out += written;
                pixel_out += written;
                holes.NextColumn();
                key = hn::Add(key, batch.key_du);
                pixel = hn::Add(pixel, hn::Set(dk, 1u));
                remaining = hn::Sub(remaining, hn::Set(d, 1.f));
                inside = hn::And(inside, hn::Gt(remaining, hn::Zero(d)));
            } while (!hn::AllFalse(d, inside));
        }
        y = hn::Add(y, hn::Set(d, 1.f));
        line = hn::Add(line, hn::Set(di, projection.width));
        line_key = hn::Add(line_key, batch.key_dv);
    }
    buffer.count = std::size_t(pixel_out - buffer.pixel);
    HWY_ALIGN std::uint32_t faces[kMostLanes];
    HWY_ALIGN std::uint32_t counts[kMostLanes];
    const auto some = hn::RebindMask(dk, hn::Gt(covered, hn::Zero(d)));
    const std::size_t written = hn::CountTrue(dk, some);
    hn::Store(hn::Compress(batch.face, some), dk, faces);
    hn::Store(hn::Compress(hn::BitCast(dk, hn::ConvertTo(di, covered)), some), dk, counts);
    for (std::size_t i = 0; i < written; ++i)
        fragments[faces[i]] += counts[i];
}

/// One polygon of a batch, to be drawn row by row.
struct LonePolygon {
    int corners = 0;
    float base[PolygonGroup::kMaxCorners], slope[PolygonGroup::kMaxCorners];
    bool left[PolygonGroup::kMaxCorners], right[PolygonGroup::kMaxCorners];
    int first_row, rows, first_column;
    std::uint32_t key0, key_du, key_dv, face;
    float u0, v0, slope_u, slope_v;

    /// Columns [first, second) of row y that are covered.
    std::pair<int, int> span(int y, int width) const {
        float low = 0, high = float(width);
        for (int k = 0; k < corners; ++k) {
            const float u = base[k] + float(y) * slope[k];
            if (left[k])
                low = std::max(low, u);
            if (right[k])
                high = std::min(high, u);
        }
        return {int(std::ceil(low)), int(std::ceil(high))};
    }
    std::uint32_t key_at(int x, int y) const {
        return key0 + std::uint32_t(x - first_column) * key_du + std::uint32_t(y - first_row) * key_dv;
    }
};

/// Calls draw(polygon, lane) for every lane of `lanes`.
template <int Corners, class Draw>
void ForEachLane(const PolygonBatch<Corners>& batch, FloatMask lanes, Draw&& draw) {
    const FloatTag d;
    HWY_ALIGN float values[2 * Corners + 7][kMostLanes];
    HWY_ALIGN std::uint32_t keys[4][kMostLanes];
    std::uint64_t left[Corners], right[Corners];
    const auto bits = [&](FloatMask mask) {
        std::uint8_t bytes[8] = {0};
        hn::StoreMaskBits(d, mask, bytes);
        std::uint64_t all = 0;
        for (int i = 0; i < 8; ++i)
            all |= std::uint64_t(bytes[i]) << (8 * i);
        return all;
    };
    for (int k = 0; k < Corners; ++k) {
        hn::Store(batch.base[k], d, values[2 * k]);
        hn::Store(batch.slope[k], d, values[2 * k + 1]);
        left[k] = bits(batch.left[k]);
        right[k] = bits(batch.right[k]);
    }
    constexpr int rest = 2 * Corners;
    const FloatVec more[7] = {batch.first_row, batch.rows,    batch.first_column, batch.u0,
                              batch.v0,        batch.slope_u, batch.slope_v};
    for (int i = 0; i < 7; ++i)
        hn::Store(more[i], d, values[rest + i]);
    const KeyVec all_keys[4] = {batch.key0, batch.key_du, batch.key_dv, batch.face};
    for (int i = 0; i < 4; ++i)
        hn::Store(all_keys[i], KeyTag(), keys[i]);
    for (std::uint64_t todo = bits(lanes); todo; todo &= todo - 1) {
        const int lane = std::countr_zero(todo);
        LonePolygon polygon;
        polygon.corners = Corners;
        for (int k = 0; k < Corners; ++k) {
            polygon.base[k] = values[2 * k][lane];
            polygon.slope[k] = values[2 * k + 1][lane];
            polygon.left[k] = left[k] >> lane & 1;
            polygon.right[k] = right[k] >> lane & 1;
        }
        polygon.first_row = int(values[rest][lane]);
        polygon.rows = int(values[rest + 1][lane]);
        polygon.first_column = int(values[rest + 2][lane]);
        polygon.u0 = values[rest + 3][lane];
        polygon.v0 = values[rest + 4][lane];
        polygon.slope_u = values[rest + 5][lane];
        polygon.slope_v = values[rest + 6][lane];
        polygon.key0 = keys[0][lane];
        polygon.key_du = keys[1][lane];
        polygon.key_dv = keys[2][lane];
        polygon.face = keys[3][lane];
        draw(polygon, std::size_t(lane));
    }
}

} // namespace kokage::bundles::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
