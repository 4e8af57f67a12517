// Vector code by Google Highway: compiled once for every instruction set, chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "foliage/bundles/line_raster.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "foliage/bundles/line_raster.h"

#include <algorithm>
#include <bit>
#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace kokage::bundles::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::ScalableTag<float>;
using IntTag = hn::RebindToSigned<FloatTag>;
using KeyTag = hn::RebindToUnsigned<FloatTag>;

/// A polygon ready to be drawn. Its keys are a plane over the picture in fixed point, depth in the bits above the
/// face's: key(x, y) = (key0 + (x - x0) key_du + (y - y0) key_dv) without its low bits | face. Arithmetic wraps, the
/// result doesn't.
struct DrawnPolygon {
    std::uint32_t key0, key_du, key_dv;
    int x0, y0;
    std::uint32_t face;
    const AlphaMask* mask;
    glm::vec2 uv0, uv_du, uv_dv;

    std::uint32_t key_at(int x, int y) const {
        return key0 + std::uint32_t(x - x0) * key_du + std::uint32_t(y - y0) * key_dv;
    }
};

/// One row of a mask test: solid pixels of [begin, end) are handed on run by run.
template <class Run>
void SolidRuns(const DrawnPolygon& polygon, int y, int begin, int end, Run&& run) {
    int start = begin;
    for (int x = begin; x < end; ++x) {
        const glm::vec2 uv = polygon.uv0 + float(x) * polygon.uv_du + float(y) * polygon.uv_dv;
        if (polygon.mask->solid(uv))
            continue;
        if (x > start)
            run(start, x);
        start = x + 1;
    }
    if (end > start)
        run(start, end);
}

/// Sixteen (or as many as a vector holds) polygons of a group, projected: what DrawLane needs of each, by lane.
struct PolygonBatch {
    static constexpr std::size_t kLanes = HWY_MAX_BYTES / 4;
    HWY_ALIGN float u[Facets::kMaxCorners][kLanes], v[Facets::kMaxCorners][kLanes];
    // Lines of the left and right edges, u = base + slope v. An edge that is not on that side is a line far outside.
    HWY_ALIGN float left_base[Facets::kMaxCorners][kLanes], left_slope[Facets::kMaxCorners][kLanes];
    HWY_ALIGN float right_base[Facets::kMaxCorners][kLanes], right_slope[Facets::kMaxCorners][kLanes];
    HWY_ALIGN int first_row[kLanes], rows[kLanes], first_column[kLanes];
    HWY_ALIGN float facing[kLanes], slope_u[kLanes], slope_v[kLanes];
    HWY_ALIGN std::uint32_t key0[kLanes], key_du[kLanes], key_dv[kLanes]; ///< key0 at (first_column, first_row)
    static constexpr int kRows = 32;                                      ///< rows that are prepared at a time
    HWY_ALIGN int begin[kRows][kLanes], end[kRows][kLanes];
    std::uint64_t alive = 0; ///< lanes that cover a row and a column of pixel centres and don't stand on edge
    int most_rows = 0;
};

/// Polygons this close to edge-on are not drawn: they hold a hundred-thousandth of the light, and their depth is too
/// steep.
constexpr float kLeastFacing = 0.004f;

struct DepthScale {
    float low, scale; ///< half the quantised depth's fixed-point value = (depth - low) * scale
};

/// Projects polygons [first, first + lanes) of a group, throws out those that can't cover a pixel, sets up edges and
/// depths.
void ProjectBatch(const PolygonGroup& group, std::size_t first, const Projection& projection, DepthScale depths,
                  PolygonBatch& batch) {
    const FloatTag d;
    const int corners = group.corners;
    const float density = projection.pixels_per_unit;
    const glm::vec3 ua = projection.u_axis * density, va = projection.v_axis * density,
                    wa = projection.direction * density;
    const auto dot = [&](const glm::vec3& axis, auto x, auto y, auto z) {
        return hn::MulAdd(x, hn::Set(d, axis.x), hn::MulAdd(y, hn::Set(d, axis.y), hn::Mul(z, hn::Set(d, axis.z))));
    };
    auto low_u = hn::Set(d, 1e30f), high_u = hn::Set(d, -1e30f), low_v = low_u, high_v = high_u, depth = hn::Zero(d);
    for (int k = 0; k < corners; ++k) {
        const std::size_t at = std::size_t(k) * group.stride + first;
        const auto x = hn::LoadU(d, &group.x[at]), y = hn::LoadU(d, &group.y[at]), z = hn::LoadU(d, &group.z[at]);
        const auto u = hn::Add(dot(ua, x, y, z), hn::Set(d, projection.offset.x));
        const auto v = hn::Add(dot(va, x, y, z), hn::Set(d, projection.offset.y));
        hn::Store(u, d, batch.u[k]);
        hn::Store(v, d, batch.v[k]);
        low_u = hn::Min(low_u, u);
        high_u = hn::Max(high_u, u);
        low_v = hn::Min(low_v, v);
        high_v = hn::Max(high_v, v);
        if (k == 0)
            depth = dot(wa, x, y, z);
    }
    const auto nx = hn::LoadU(d, &group.normal_x[first]), ny = hn::LoadU(d, &group.normal_y[first]),
               nz = hn::LoadU(d, &group.normal_z[first]);
    const auto facing = dot(projection.direction, nx, ny, nz);
    const auto first_row = hn::Ceil(low_v), rows = hn::Sub(hn::Ceil(high_v), first_row);
    const auto first_column = hn::Ceil(low_u), columns = hn::Sub(hn::Ceil(high_u), first_column);
    auto alive = hn::And(hn::Gt(rows, hn::Zero(d)), hn::Gt(columns, hn::Zero(d)));
    alive = hn::And(alive, hn::Gt(hn::Abs(facing), hn::Set(d, kLeastFacing)));
    alive = hn::And(alive, hn::FirstN(d, group.count - first));
    batch.alive = 0;
    if (hn::AllFalse(d, alive))
        return;
    std::uint8_t bits[8] = {0};
    hn::StoreMaskBits(d, alive, bits);
    for (int i = 0; i < 8; ++i)
        batch.alive |= std::uint64_t(bits[i]) << (8 * i);

    const hn::RebindToSigned<FloatTag> di;
    const hn::RebindToUnsigned<FloatTag> dk;
    const auto drawn_rows = hn::IfThenElseZero(alive, rows);
    batch.most_rows = int(hn::GetLane(hn::MaxOfLanes(d, drawn_rows)));
    hn::Store(hn::ConvertTo(di, first_row), di, batch.first_row);
    hn::Store(hn::ConvertTo(di, first_column), di, batch.first_column);
    hn::Store(hn::ConvertTo(di, drawn_rows), di, batch.rows);
    hn::Store(facing, d, batch.facing);
    // The plane n . (p - p0) = 0 as depth over the picture.
    const auto inverse = hn::Div(hn::Set(d, -1.f), hn::IfThenElse(alive, facing, hn::Set(d, 1.f)));
    const auto slope_u = hn::Mul(dot(projection.u_axis, nx, ny, nz), inverse),
               slope_v = hn::Mul(dot(projection.v_axis, nx, ny, nz), inverse);
    hn::Store(slope_u, d, batch.slope_u);
    hn::Store(slope_v, d, batch.slope_v);
    const auto to_first = hn::MulAdd(hn::Sub(first_column, hn::Load(d, batch.u[0])), slope_u,
                                     hn::Mul(hn::Sub(first_row, hn::Load(d, batch.v[0])), slope_v));
    const auto scale = hn::Set(d, depths.scale);
    // At the corner of a steep polygon's box the plane lies far outside the depths, and a conversion would saturate.
    // Whole turns are taken off first: keys wrap, so the pixels that are covered get their own depths all the same.
    const auto fixed = [&](auto value) {
        const auto half = hn::Mul(value, scale), turns = hn::Round(hn::Mul(half, hn::Set(d, 0x1p-31f)));
        const auto wrapped = hn::NegMulAdd(turns, hn::Set(d, 0x1p31f), half);
        return hn::ShiftLeft<1>(hn::BitCast(dk, hn::ConvertTo(di, wrapped)));
    };
    hn::Store(fixed(hn::Add(hn::Sub(depth, hn::Set(d, depths.low)), to_first)), dk, batch.key0);
    hn::Store(fixed(slope_u), dk, batch.key_du);
    hn::Store(fixed(slope_v), dk, batch.key_dv);

    // Counter-clockwise seen from the near end when facing < 0: then edges that rise in v are on the right.
    const auto turned = hn::Lt(facing, hn::Zero(d));
    const auto far_left = hn::Set(d, -1e30f), far_right = hn::Set(d, 1e30f);
    for (int k = 0, j = corners - 1; k < corners; j = k++) {
        const auto uj = hn::Load(d, batch.u[j]), vj = hn::Load(d, batch.v[j]);
        const auto dv = hn::Sub(hn::Load(d, batch.v[k]), vj);
        const auto slope = hn::Div(hn::Sub(hn::Load(d, batch.u[k]), uj), dv);
        const auto base = hn::NegMulAdd(vj, slope, uj);
        const auto rising = hn::Gt(dv, hn::Zero(d)), falling = hn::Lt(dv, hn::Zero(d));
        const auto right = hn::Or(hn::And(rising, turned), hn::AndNot(turned, falling));
        const auto left = hn::Or(hn::And(falling, turned), hn::AndNot(turned, rising));
        hn::Store(hn::IfThenElse(left, base, far_left), d, batch.left_base[k]);
        hn::Store(hn::IfThenElseZero(left, slope), d, batch.left_slope[k]);
        hn::Store(hn::IfThenElse(right, base, far_right), d, batch.right_base[k]);
        hn::Store(hn::IfThenElseZero(right, slope), d, batch.right_slope[k]);
    }
}

/// Texture coordinates over the picture: moving a pixel moves along the plane, (u_axis + direction slope_u) / density.
void SetTexture(const PolygonGroup& group, std::size_t index, const Projection& projection, const PolygonBatch& batch,
                int lane, DrawnPolygon& polygon) {
    const TextureMap& map = group.texture[index];
    const glm::vec3 along_u =
        (projection.u_axis + projection.direction * batch.slope_u[lane]) / projection.pixels_per_unit;
    const glm::vec3 along_v =
        (projection.v_axis + projection.direction * batch.slope_v[lane]) / projection.pixels_per_unit;
    polygon.uv_du = {glm::dot(map.u_gradient, along_u), glm::dot(map.v_gradient, along_u)};
    polygon.uv_dv = {glm::dot(map.u_gradient, along_v), glm::dot(map.v_gradient, along_v)};
    const glm::vec3 from_point = glm::vec3(group.x[index], group.y[index], group.z[index]) - map.point;
    const glm::vec2 uv_corner =
        map.uv + glm::vec2(glm::dot(map.u_gradient, from_point), glm::dot(map.v_gradient, from_point));
    polygon.uv0 = uv_corner - batch.u[0][lane] * polygon.uv_du - batch.v[0][lane] * polygon.uv_dv;
}

/// The spans of rows [first, first + kRows) of all polygons of a batch: columns [begin, end), empty where end <= begin.
HWY_INLINE void FindSpans(PolygonBatch& batch, int corners, int width, int first) {
    const FloatTag d;
    const hn::RebindToSigned<FloatTag> di;
    const int rows = std::min(batch.most_rows - first, PolygonBatch::kRows);
    auto y = hn::ConvertTo(d, hn::Add(hn::Load(di, batch.first_row), hn::Set(di, first)));
    for (int r = 0; r < rows; ++r) {
        // Clamped to the picture, so that rounding at nearly horizontal edges can never leave it.
        auto left = hn::Zero(d), right = hn::Set(d, float(width));
        for (int k = 0; k < corners; ++k) {
            left = hn::Max(left, hn::MulAdd(y, hn::Load(d, batch.left_slope[k]), hn::Load(d, batch.left_base[k])));
            right = hn::Min(right, hn::MulAdd(y, hn::Load(d, batch.right_slope[k]), hn::Load(d, batch.right_base[k])));
        }
        hn::Store(hn::ConvertTo(di, hn::Ceil(left)), di, batch.begin[r]);
        hn::Store(hn::ConvertTo(di, hn::Ceil(right)), di, batch.end[r]);
        y = hn::Add(y, hn::Set(d, 1.f));
    }
}

/// Calls row(polygon, y, begin, end) for every row of pixels that each facet covers solidly; counts fragments per face.
template <class Row>
void DrawPolygons(const PatchScene& scene, const Facets& facets, const Projection& projection, RasterScratch& scratch,
                  Row&& row) {
    const std::size_t lanes = hn::Lanes(FloatTag());
    const DepthScale depths{projection.depth_low,
                            2147483000.f / std::max(projection.depth_high - projection.depth_low, 1e-20f)};
    PolygonBatch batch;
    for (const PolygonGroup& group : facets.groups)
        for (std::size_t first = 0; first < group.count; first += lanes) {
            ProjectBatch(group, first, projection, depths, batch);
            if (!batch.alive)
                continue;
            for (int first_row = 0; first_row < batch.most_rows; first_row += PolygonBatch::kRows) {
                FindSpans(batch, group.corners, projection.width, first_row);
                for (std::uint64_t alive = batch.alive; alive; alive &= alive - 1) {
                    const int lane = std::countr_zero(alive);
                    const std::size_t index = first + std::size_t(lane);
                    DrawnPolygon polygon{};
                    polygon.face = group.face[index] + std::uint32_t(group.bark[index] && batch.facing[lane] > 0);
                    polygon.key0 = batch.key0[lane];
                    polygon.key_du = batch.key_du[lane];
                    polygon.key_dv = batch.key_dv[lane];
                    polygon.x0 = batch.first_column[lane];
                    polygon.y0 = batch.first_row[lane];
                    if (group.mask[index] >= 0) {
                        polygon.mask = &scene.masks[std::size_t(group.mask[index])];
                        SetTexture(group, index, projection, batch, lane, polygon);
                    }
                    const int rows = std::min(batch.rows[lane] - first_row, PolygonBatch::kRows);
                    std::uint32_t fragments = 0;
                    for (int r = 0; r < rows; ++r) {
                        const int begin = batch.begin[r][lane], end = batch.end[r][lane];
                        if (end <= begin)
                            continue;
                        const int y = polygon.y0 + first_row + r;
                        auto run = [&](int a, int b) {
                            fragments += std::uint32_t(b - a);
                            row(polygon, y, a, b);
                        };
                        if (!polygon.mask)
                            run(begin, end);
                        else
                            SolidRuns(polygon, y, begin, end, run);
                    }
                    scratch.fragments[polygon.face] += fragments;
                }
            }
        }
}

/// Depth keys of the pixels x, x+1, ... of row y.
HWY_INLINE hn::Vec<KeyTag> Keys(const DrawnPolygon& polygon, std::uint32_t face_mask, int x, int y) {
    const KeyTag dk;
    const auto steps = hn::Mul(hn::Iota(dk, 0u), hn::Set(dk, polygon.key_du));
    const auto key = hn::Add(hn::Set(dk, polygon.key_at(x, y)), steps);
    return hn::Or(hn::AndNot(hn::Set(dk, face_mask), key), hn::Set(dk, polygon.face));
}

void DrawEnds(const PatchScene& scene, const Facets& facets, const Projection& projection, bool both,
              RasterScratch& scratch) {
    const FloatTag d;
    const KeyTag dk;
    const int lanes = int(hn::Lanes(d));
    const std::uint32_t face_mask = (1u << face_bits(facets)) - 1;
    auto draw = [&]<bool Both>() {
        DrawPolygons(scene, facets, projection, scratch, [&](const DrawnPolygon& polygon, int y, int begin, int end) {
            const std::size_t line = std::size_t(y) * std::size_t(projection.width);
            std::uint32_t* near_line = scratch.near_keys.data() + line;
            std::uint32_t* far_line = Both ? scratch.far_keys.data() + line : nullptr;
            for (int x = begin; x < end; x += lanes) {
                const auto key = Keys(polygon, face_mask, x, y);
                const auto inside = hn::FirstN(dk, std::size_t(std::min(lanes, end - x)));
                // The buffers are padded by a vector, so that whole vectors may be read and blended back.
                const auto near_key = hn::LoadU(dk, near_line + x);
                hn::BlendedStore(hn::Min(near_key, key), inside, dk, near_line + x);
                if constexpr (Both) {
                    const auto far_key = hn::LoadU(dk, far_line + x);
                    hn::BlendedStore(hn::Max(far_key, key), inside, dk, far_line + x);
                }
            }
        });
    };
    if (both)
        draw.operator()<true>();
    else
        draw.operator()<false>();
}

void DrawFragments(const PatchScene& scene, const Facets& facets, const Projection& projection,
                   RasterScratch& scratch) {
    const FloatTag d;
    const KeyTag dk;
    const int lanes = int(hn::Lanes(d));
    const std::uint32_t face_mask = (1u << face_bits(facets)) - 1;
    std::uint32_t* per_pixel = scratch.pixel_begin.data() + 1;
    std::size_t count = 0;
    DrawPolygons(scene, facets, projection, scratch, [&](const DrawnPolygon& polygon, int y, int begin, int end) {
        const std::size_t line = std::size_t(y) * std::size_t(projection.width);
        const std::size_t need = count + std::size_t(end - begin) + std::size_t(lanes);
        if (need > scratch.fragment_pixel.size()) {
            scratch.fragment_pixel.resize(need * 2);
            scratch.fragment_key.resize(need * 2);
        }
        for (int x = begin; x < end; x += lanes) {
            const int n = std::min(lanes, end - x);
            const auto inside = hn::FirstN(dk, std::size_t(n));
            hn::StoreU(Keys(polygon, face_mask, x, y), dk, scratch.fragment_key.data() + count);
            hn::StoreU(hn::Iota(dk, std::uint32_t(line + std::size_t(x))), dk, scratch.fragment_pixel.data() + count);
            std::uint32_t* counter = per_pixel + line + x;
            const auto one = hn::IfThenElseZero(inside, hn::Set(dk, 1u));
            hn::BlendedStore(hn::Add(hn::LoadU(dk, counter), one), inside, dk, counter);
            count += std::size_t(n);
        }
    });
    scratch.fragment_count = count;
}

} // namespace kokage::bundles::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kokage::bundles {

HWY_EXPORT(DrawEnds);
HWY_EXPORT(DrawFragments);

namespace {

constexpr std::size_t kPadding =
    64; // floats: more than the widest vector of any target (HWY_MAX_BYTES speaks of one target)

void prepare(const Facets& facets, RasterScratch& scratch) {
    scratch.fragments.assign(facets.face_count(), 0);
}

/// Counts at which pixels a face is the nearest / farthest one.
void count_ends(const std::vector<std::uint32_t>& keys, std::size_t pixels, std::uint32_t empty,
                std::uint32_t face_mask, std::vector<std::uint32_t>& counts) {
    for (std::size_t i = 0; i < pixels; ++i)
        if (keys[i] != empty)
            ++counts[keys[i] & face_mask];
}

} // namespace

int face_bits(const Facets& facets) {
    return std::max(1, int(std::bit_width(facets.face_count())));
}

Projection fit_projection(const Facets& facets, const glm::vec3& direction, float pixels_per_unit, glm::vec2 jitter) {
    Projection projection;
    projection.direction = direction;
    // Any frame around the direction will do; this one has no poles (Duff et al. 2017, Building an Orthonormal Basis,
    // Revisited).
    const float sign = std::copysign(1.f, direction.z);
    const float a = -1 / (sign + direction.z), b = direction.x * direction.y * a;
    projection.u_axis = {1 + sign * direction.x * direction.x * a, sign * b, -sign * direction.x};
    projection.v_axis = -glm::vec3(b, sign + direction.y * direction.y * a, -direction.y);
    projection.pixels_per_unit = pixels_per_unit;

    // The box's extent along an axis is the sum of its half sizes' shares.
    const glm::vec3 centre = 0.5f * (facets.low + facets.high), half = 0.5f * (facets.high - facets.low);
    auto range = [&](const glm::vec3& axis) {
        const float middle = glm::dot(centre, axis), reach = glm::dot(half, glm::abs(axis));
        return glm::vec2(middle - reach, middle + reach) * pixels_per_unit;
    };
    const glm::vec2 u = range(projection.u_axis), v = range(projection.v_axis), w = range(direction);
    projection.offset = glm::vec2(1 - u.x, 1 - v.x) + jitter;
    projection.width = int(std::ceil(u.y - u.x)) + 3;
    projection.height = int(std::ceil(v.y - v.x)) + 3;
    const float margin = 2 + 1e-2f * (w.y - w.x);
    projection.depth_low = w.x - margin;
    projection.depth_high = w.y + margin;
    return projection;
}

void draw_ends(const PatchScene& scene, const Facets& facets, const Projection& projection, bool both,
               RasterScratch& scratch) {
    prepare(facets, scratch);
    const std::size_t pixels = std::size_t(projection.width) * std::size_t(projection.height);
    scratch.near_keys.assign(pixels + kPadding, kNoKey);
    if (both)
        scratch.far_keys.assign(pixels + kPadding, 0);
    HWY_DYNAMIC_DISPATCH(DrawEnds)(scene, facets, projection, both, scratch);
    const std::uint32_t face_mask = (1u << face_bits(facets)) - 1;
    scratch.near_count.assign(facets.face_count(), 0);
    count_ends(scratch.near_keys, pixels, kNoKey, face_mask, scratch.near_count);
    if (both) {
        scratch.far_count.assign(facets.face_count(), 0);
        count_ends(scratch.far_keys, pixels, 0, face_mask, scratch.far_count);
    }
}

void draw_fragments(const PatchScene& scene, const Facets& facets, const Projection& projection,
                    RasterScratch& scratch) {
    prepare(facets, scratch);
    const std::size_t pixels = std::size_t(projection.width) * std::size_t(projection.height);
    scratch.pixel_begin.assign(pixels + 1 + kPadding, 0);
    HWY_DYNAMIC_DISPATCH(DrawFragments)(scene, facets, projection, scratch);

    // Counting sort by pixel; pixel_begin[p + 1] holds the count of p and becomes the cursor of p, which ends at begin
    // of p + 1.
    std::uint32_t running = 0;
    for (std::size_t p = 1; p <= pixels; ++p) {
        const std::uint32_t count = scratch.pixel_begin[p];
        scratch.pixel_begin[p] = running;
        running += count;
    }
    scratch.sorted_keys.resize(scratch.fragment_count);
    std::uint32_t* cursor = scratch.pixel_begin.data() + 1;
    for (std::size_t f = 0; f < scratch.fragment_count; ++f)
        scratch.sorted_keys[cursor[scratch.fragment_pixel[f]]++] = scratch.fragment_key[f];

    scratch.near_count.assign(facets.face_count(), 0);
    scratch.far_count.assign(facets.face_count(), 0);
    const std::uint32_t face_mask = (1u << face_bits(facets)) - 1;
    for (std::size_t p = 0; p < pixels; ++p) {
        std::uint32_t* begin = scratch.sorted_keys.data() + scratch.pixel_begin[p];
        std::uint32_t* end = scratch.sorted_keys.data() + scratch.pixel_begin[p + 1];
        if (begin == end)
            continue;
        for (std::uint32_t* i = begin + 1; i < end; ++i) { // a pixel holds a few fragments: insertion sort
            const std::uint32_t key = *i;
            std::uint32_t* j = i;
            for (; j > begin && j[-1] > key; --j)
                *j = j[-1];
            *j = key;
        }
        ++scratch.near_count[*begin & face_mask];
        ++scratch.far_count[end[-1] & face_mask];
    }
}

} // namespace kokage::bundles
#endif
