#include "common/services/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "foliage/bundles/line_raster.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "foliage/bundles/polygon_batch-inl.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

HWY_BEFORE_NAMESPACE();
namespace kokage::bundles::HWY_NAMESPACE {

/// Room that one call of a drawing function below may need.
constexpr std::size_t kBatchRoom = kMostMaskedRows * kMostMaskedColumns * kMostLanes + 2 * kMostLanes;
static_assert(kMostMaskedRows >= kMostBatchRows && kMostMaskedColumns >= kMostBatchColumns);

/// The test of a polygon's fragments against its mask.
struct MaskTest {
    const AlphaMask* mask;
    glm::vec2 uv0, uv_du, uv_dv;
    bool solid(int x, int y) const { return mask->solid(uv0 + float(x) * uv_du + float(y) * uv_dv); }
};

/// Texture coordinates over the picture: moving a pixel moves along the plane, (u_axis + direction slope_u) / density.
MaskTest MakeMaskTest(const PatchScene& scene, const PolygonGroup& group, std::size_t index,
                      const Projection& projection, const LonePolygon& polygon) {
    const glm::vec3 along_u = (projection.u_axis + projection.direction * polygon.slope_u) / projection.pixels_per_unit;
    const glm::vec3 along_v = (projection.v_axis + projection.direction * polygon.slope_v) / projection.pixels_per_unit;
    MaskTest test;
    test.mask = &scene.masks[std::size_t(group.texels.mask[index])];
    const glm::vec2 size(float(test.mask->alpha->width), float(test.mask->alpha->height));
    for (int axis = 0; axis < 2; ++axis) {
        const auto& texels = group.texels.gradient[std::size_t(axis)];
        const glm::vec3 gradient = glm::vec3(texels[0][index], texels[1][index], texels[2][index]) / size[axis];
        test.uv_du[axis] = glm::dot(gradient, along_u);
        test.uv_dv[axis] = glm::dot(gradient, along_v);
        test.uv0[axis] = group.texels.at_corner[std::size_t(axis)][index] / size[axis] - polygon.u0 * test.uv_du[axis] -
                         polygon.v0 * test.uv_dv[axis];
    }
    return test;
}

/// Draws one polygon row by row, with a mask test if it has one. `make_room` is called before every row.
template <class MakeRoom>
void DrawLone(const LonePolygon& polygon, const MaskTest* test, const Projection& projection, std::uint32_t face_mask,
              FragmentBuffer& buffer, std::uint32_t* fragments, MakeRoom&& make_room) {
    const int end_row = std::min(polygon.first_row + polygon.rows, projection.height);
    for (int y = std::max(polygon.first_row, 0); y < end_row; ++y) {
        const auto [begin, end] = polygon.span(y, projection.width);
        const std::uint32_t line = std::uint32_t(y) * std::uint32_t(projection.width);
        const std::size_t before = buffer.count;
        for (int x = begin; x < end; ++x) {
            if (test && !test->solid(x, y))
                continue;
            buffer.pixel[buffer.count] = line + std::uint32_t(x);
            buffer.key[buffer.count++] = (polygon.key_at(x, y) & ~face_mask) | polygon.face;
        }
        fragments[polygon.face] += std::uint32_t(buffer.count - before);
        make_room();
    }
}

template <int Corners, class MakeRoom>
void DrawGroup(const PatchScene& scene, const MaskBits& bits, const PolygonGroup& group, const Projection& projection,
               std::uint32_t face_mask, FragmentBuffer& buffer, std::uint32_t* fragments, MakeRoom&& make_room) {
    const FloatTag d;
    const std::size_t lanes = hn::Lanes(d);
    const DepthScale depths{projection.depth_low,
                            2147483000.f / std::max(projection.depth_high - projection.depth_low, 1e-20f)};
    PolygonBatch<Corners> batch;
    for (std::size_t first = 0; first < group.count; first += lanes) {
        if (!ProjectBatch<Corners>(group, first, projection, depths, batch))
            continue;
        const int most_rows = group.masked ? kMostMaskedRows : kMostBatchRows,
                  most_columns = group.masked ? kMostMaskedColumns : kMostBatchColumns;
        auto alone = hn::Or(hn::Gt(batch.rows, hn::Set(d, float(most_rows))),
                            hn::Gt(batch.columns, hn::Set(d, float(most_columns))));
        if (group.masked)
            alone = hn::Or(alone, hn::Gt(hn::LoadU(d, &group.texels.wraps[first]), hn::Zero(d)));
        if (projection.clips) {
            const auto zero = hn::Zero(d), width = hn::Set(d, float(projection.width)),
                       height = hn::Set(d, float(projection.height)),
                       end_column = hn::Add(batch.first_column, batch.columns),
                       end_row = hn::Add(batch.first_row, batch.rows);
            const auto meets = hn::And(hn::And(hn::Gt(end_column, zero), hn::Lt(batch.first_column, width)),
                                       hn::And(hn::Gt(end_row, zero), hn::Lt(batch.first_row, height)));
            const auto inside = hn::And(hn::And(hn::Ge(batch.first_column, zero), hn::Le(end_column, width)),
                                        hn::And(hn::Ge(batch.first_row, zero), hn::Le(end_row, height)));
            batch.alive = hn::And(batch.alive, meets);
            alone = hn::Or(alone, hn::Not(inside));
        }
        alone = hn::And(alone, batch.alive);
        const auto together = hn::AndNot(alone, batch.alive);
        if (group.masked)
            DrawBatch<Corners>(batch, together, HolesOfBatch(group, first, bits, projection, batch, together),
                               projection, face_mask, buffer, fragments);
        else
            DrawBatch<Corners>(batch, together, NoHoles(), projection, face_mask, buffer, fragments);
        if (HWY_UNLIKELY(!hn::AllFalse(d, alone))) {
            make_room();
            ForEachLane<Corners>(batch, alone, [&](const LonePolygon& polygon, std::size_t lane) {
                if (group.masked) {
                    const MaskTest test = MakeMaskTest(scene, group, first + lane, projection, polygon);
                    DrawLone(polygon, &test, projection, face_mask, buffer, fragments, make_room);
                } else {
                    DrawLone(polygon, nullptr, projection, face_mask, buffer, fragments, make_room);
                }
            });
        }
        make_room();
    }
}

/// Fills the buffer with the fragments of all facets and counts them by face. make_room() is called whenever up to
/// kBatchRoom or a row of fragments may have been added, and must leave room for as many.
template <class MakeRoom>
void DrawPolygons(const PatchScene& scene, const Facets& facets, const Projection& projection, FragmentBuffer& buffer,
                  std::uint32_t* fragments, MakeRoom&& make_room) {
    const std::uint32_t face_mask = (1u << face_bits(facets)) - 1;
    for (const PolygonGroup& group : facets.groups) {
        auto draw = [&]<int Corners>() {
            DrawGroup<Corners>(scene, facets.mask_bits, group, projection, face_mask, buffer, fragments, make_room);
        };
        switch (group.corners) {
        case 3:
            draw.template operator()<3>();
            break;
        case 4:
            draw.template operator()<4>();
            break;
        case 5:
            draw.template operator()<5>();
            break;
        case 6:
            draw.template operator()<6>();
            break;
        case 7:
            draw.template operator()<7>();
            break;
        default:
            draw.template operator()<8>();
            break;
        }
    }
}

void DrawEnds(const PatchScene& scene, const Facets& facets, const Projection& projection, bool both,
              RasterScratch& scratch) {
    const std::size_t room = kBatchRoom + std::size_t(projection.width);
    scratch.fragment_pixel.resize(std::max(scratch.fragment_pixel.size(), 2 * room));
    scratch.fragment_key.resize(scratch.fragment_pixel.size());
    FragmentBuffer buffer{scratch.fragment_pixel.data(), scratch.fragment_key.data()};
    std::uint32_t *near_keys = scratch.near_keys.data(), *far_keys = both ? scratch.far_keys.data() : nullptr;
    auto empty = [&] {
        for (std::size_t i = 0; i < buffer.count; ++i) {
            const std::uint32_t pixel = buffer.pixel[i], key = buffer.key[i];
            near_keys[pixel] = std::min(near_keys[pixel], key);
            if (both)
                far_keys[pixel] = std::max(far_keys[pixel], key);
        }
        buffer.count = 0;
    };
    constexpr std::size_t kWorthEmptying = 1024; // keeps the buffer in the fastest cache
    DrawPolygons(scene, facets, projection, buffer, scratch.fragments.data(), [&] {
        if (buffer.count >= kWorthEmptying)
            empty();
    });
    empty();
}

void DrawFragments(const PatchScene& scene, const Facets& facets, const Projection& projection,
                   RasterScratch& scratch) {
    const std::size_t room = kBatchRoom + std::size_t(projection.width);
    FragmentBuffer buffer{};
    auto make_room = [&] {
        if (const std::size_t need = buffer.count + room; need > scratch.fragment_pixel.size()) {
            scratch.fragment_pixel.resize(2 * need);
            scratch.fragment_key.resize(2 * need);
        }
        buffer.pixel = scratch.fragment_pixel.data();
        buffer.key = scratch.fragment_key.data();
    };
    scratch.fragment_key.resize(scratch.fragment_pixel.size());
    make_room();
    DrawPolygons(scene, facets, projection, buffer, scratch.fragments.data(), make_room);
    scratch.fragment_count = buffer.count;
}

/// Counts at which pixels a face is the nearest / farthest one. `pixels`: a multiple of FragmentLists::kGroup.
void CountEnds(const std::uint32_t* keys, std::size_t pixels, std::uint32_t empty, std::uint32_t face_mask,
               std::uint32_t* counts) {
    const hn::CappedTag<std::uint32_t, FragmentLists::kGroup> d;
    const std::size_t lanes = hn::Lanes(d);
    HWY_ALIGN std::uint32_t faces[FragmentLists::kGroup] = {};
    for (std::size_t pixel = 0; pixel < pixels; pixel += lanes) {
        const auto key = hn::LoadU(d, keys + pixel);
        const auto drawn = hn::Ne(key, hn::Set(d, empty));
        if (hn::AllFalse(d, drawn))
            continue;
        hn::Store(hn::Compress(hn::And(key, hn::Set(d, face_mask)), drawn), d, faces);
        const std::size_t count = hn::CountTrue(d, drawn);
        for (std::size_t i = 0; i < count; ++i)
            ++counts[faces[i]];
    }
}

} // namespace kokage::bundles::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kokage::bundles {

HWY_EXPORT(DrawEnds);
HWY_EXPORT(DrawFragments);
HWY_EXPORT(CountEnds);

namespace {

void prepare(const Facets& facets, RasterScratch& scratch) {
    scratch.fragments.assign(facets.face_count(), 0);
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

    // A box's extent along an axis is the sum of its half sizes' shares.
    auto range = [&](const Box& box, const glm::vec3& axis) {
        const float middle = glm::dot(0.5f * (box.low + box.high), axis),
                    reach = glm::dot(0.5f * (box.high - box.low), glm::abs(axis));
        return glm::vec2(middle - reach, middle + reach) * pixels_per_unit;
    };
    // The scene's box says where the grid lies, so that it doesn't depend on how the polygons are held by boxes; those
    // say which part of it is needed. The part begins at a whole number of kStep pixels.
    const Box whole{facets.low, facets.high};
    auto place = [&](const glm::vec3& axis, float shift, float& offset, int& size) {
        constexpr float kStep = 4; // what follows every 2nd or 4th pixel follows the same ones
        const float origin = 1 - range(whole, axis).x + shift;
        float low = std::numeric_limits<float>::max(), high = -low;
        for (const Box& box : facets.boxes) {
            const glm::vec2 extent = range(box, axis) + origin;
            low = std::min(low, extent.x);
            high = std::max(high, extent.y);
        }
        if (facets.boxes.empty())
            low = high = 1;
        const float first = kStep * std::floor((low - 1) / kStep);
        offset = origin - first;
        size = int(std::ceil(high - first)) + 2;
    };
    place(projection.u_axis, jitter.x, projection.offset.x, projection.width);
    place(projection.v_axis, jitter.y, projection.offset.y, projection.height);
    constexpr int group = FragmentLists::kGroup;
    projection.width = (projection.width + group - 1) / group * group;
    const glm::vec2 w = range(whole, direction);
    const float margin = 2 + 1e-2f * (w.y - w.x);
    projection.depth_low = w.x - margin;
    projection.depth_high = w.y + margin;
    projection.clips = !facets.wide_patches.empty();
    return projection;
}

void draw_ends(const PatchScene& scene, const Facets& facets, const Projection& projection, bool both,
               RasterScratch& scratch) {
    prepare(facets, scratch);
    const std::size_t pixels = std::size_t(projection.width) * std::size_t(projection.height);
    scratch.near_keys.assign(pixels, kNoKey);
    if (both)
        scratch.far_keys.assign(pixels, 0);
    HWY_DYNAMIC_DISPATCH(DrawEnds)(scene, facets, projection, both, scratch);
    const std::uint32_t face_mask = (1u << face_bits(facets)) - 1;
    auto count = [&](const std::vector<std::uint32_t>& keys, std::uint32_t empty, std::vector<std::uint32_t>& counts) {
        counts.assign(facets.face_count(), 0);
        HWY_DYNAMIC_DISPATCH(CountEnds)(keys.data(), pixels, empty, face_mask, counts.data());
    };
    count(scratch.near_keys, kNoKey, scratch.near_count);
    if (both)
        count(scratch.far_keys, 0, scratch.far_count);
}

void draw_fragments(const PatchScene& scene, const Facets& facets, const Projection& projection,
                    RasterScratch& scratch) {
    prepare(facets, scratch);
    const std::size_t pixels = std::size_t(projection.width) * std::size_t(projection.height);
    HWY_DYNAMIC_DISPATCH(DrawFragments)(scene, facets, projection, scratch);

    scratch.near_count.assign(facets.face_count(), 0);
    scratch.far_count.assign(facets.face_count(), 0);
    sort_fragments(pixels, std::span(scratch.fragment_pixel).first(scratch.fragment_count),
                   std::span(scratch.fragment_key).first(scratch.fragment_count), (1u << face_bits(facets)) - 1,
                   scratch.lists, scratch.near_count, scratch.far_count);
}

} // namespace kokage::bundles
#endif
