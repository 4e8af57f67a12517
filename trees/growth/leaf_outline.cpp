#include "trees/growth/leaf_outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace kokage {
namespace {

/// Half-width of an oak leaf along its length: an obovate blade with three round lobes a side and one at the tip, and
/// narrow bays that reach almost halfway to the midrib.
float oak_half_width(float y) {
    const float blade = 0.5f * std::pow(std::sin(kPi * std::pow(y, 1.35f)), 0.7f); // widest at y = 0.6
    const float lobes = std::abs(std::cos(4 * kPi * y));                           // 1 at y = 1/4, 1/2, 3/4, 1
    return blade * (0.56f + 0.44f * std::pow(lobes, 0.8f));
}

/// The blade without teeth: half-widths at heights, joined by a curve. The first is at the base, the last at the tip.
using Curve = std::vector<glm::vec2>;

/// Between the given points a cubic through them with slopes that never overshoot (Fritsch and Carlson 1980, in the
/// simpler form of Fritsch and Butland 1984: the harmonic mean of the neighbouring slopes).
float half_width_at(const Curve& curve, float y) {
    std::size_t i = 1;
    while (i + 1 < curve.size() && curve[i].y < y)
        ++i;
    const auto slope = [&](std::size_t k) { return (curve[k].x - curve[k - 1].x) / (curve[k].y - curve[k - 1].y); };
    const auto tangent = [&](std::size_t k) {
        if (k == 0)
            return slope(1) * 1.6f; // edges leave the base and reach the tip in a curve
        if (k + 1 == curve.size())
            return slope(k);
        const float a = slope(k), b = slope(k + 1);
        return a * b > 0 ? 2 * a * b / (a + b) : 0.f;
    };
    const float height = curve[i].y - curve[i - 1].y, t = std::clamp((y - curve[i - 1].y) / height, 0.f, 1.f);
    const float t2 = t * t, t3 = t2 * t;
    return std::max(0.f, (2 * t3 - 3 * t2 + 1) * curve[i - 1].x + (t3 - 2 * t2 + t) * height * tangent(i - 1) +
                             (3 * t2 - 2 * t3) * curve[i].x + (t3 - t2) * height * tangent(i));
}

/// A blade with a simple edge: its curve, teeth that point to the tip, and where coarse shapes have their vertices.
struct SimpleBlade {
    Curve curve;
    int teeth;
    float tooth_depth; ///< of the blade's width
    bool round_teeth;  ///< waves rather than saw teeth
    std::array<float, 3> coarse_heights;
};

/// After the species' descriptions in Stace, New Flora of the British Isles (3rd ed. 2010); the cherry's (Prunus
/// serrulata) in Flora of China 9, 2003.
SimpleBlade simple_blade(LeafKind kind) {
    switch (kind) {
    case LeafKind::beech: // ovate-elliptic, wavy, short-pointed
        return {{{0, 0}, {0.24f, 0.07f}, {0.43f, 0.24f}, {0.5f, 0.43f}, {0.45f, 0.62f}, {0.27f, 0.83f}, {0, 1}},
                7,
                0.022f,
                true,
                {0.20f, 0.48f, 0.78f}};
    case LeafKind::birch: // triangular, long-pointed, cut off at the base, doubly toothed
        return {{{0, 0},
                 {0.27f, 0.035f},
                 {0.44f, 0.12f},
                 {0.5f, 0.22f},
                 {0.42f, 0.40f},
                 {0.27f, 0.61f},
                 {0.11f, 0.82f},
                 {0, 1}},
                9,
                0.05f,
                false,
                {0.11f, 0.30f, 0.72f}};
    case LeafKind::willow: // lanceolate, finely toothed
        return {{{0, 0}, {0.2f, 0.09f}, {0.4f, 0.24f}, {0.5f, 0.42f}, {0.42f, 0.62f}, {0.21f, 0.84f}, {0, 1}},
                12,
                0.03f,
                false,
                {0.20f, 0.45f, 0.76f}};
    case LeafKind::aspen: // nearly round, with blunt teeth
        return {{{0, 0},
                 {0.22f, 0.025f},
                 {0.40f, 0.14f},
                 {0.5f, 0.40f},
                 {0.47f, 0.60f},
                 {0.34f, 0.80f},
                 {0.13f, 0.94f},
                 {0, 1}},
                8,
                0.045f,
                true,
                {0.12f, 0.45f, 0.82f}};
    case LeafKind::cherry: // ovate, with a drawn-out tip and bristly teeth
        return {{{0, 0},
                 {0.23f, 0.07f},
                 {0.42f, 0.22f},
                 {0.5f, 0.40f},
                 {0.45f, 0.57f},
                 {0.30f, 0.74f},
                 {0.12f, 0.88f},
                 {0, 1}},
                13,
                0.045f,
                false,
                {0.18f, 0.45f, 0.76f}};
    default:
        throw std::logic_error("leaf outline: this leaf has no simple blade");
    }
}

/// Two vertices a tooth: the notch below it, and its point.
HalfOutline toothed(const SimpleBlade& blade, int teeth, float depth) {
    HalfOutline half = {{0, 0}};
    for (int i = 0; i < teeth; ++i) {
        const float low = (float(i) + 0.35f) / float(teeth),
                    high = (float(i) + (blade.round_teeth ? 0.85f : 0.95f)) / float(teeth);
        const float y0 = 0.98f * low, y1 = 0.98f * high;
        const float notch = half_width_at(blade.curve, y0), point = half_width_at(blade.curve, y1);
        half.push_back({std::max(0.4f * notch, notch - depth), y0});
        half.push_back({std::min(0.5f, point), y1});
    }
    half.push_back({0, 1});
    return half;
}

HalfOutline smooth(const SimpleBlade& blade, int vertices) {
    HalfOutline half = {{0, 0}};
    for (int i = 1; i <= vertices; ++i) {
        const float y = float(i) / float(vertices + 1);
        half.push_back({half_width_at(blade.curve, y), y});
    }
    half.push_back({0, 1});
    return half;
}

HalfOutline simple_outline(LeafKind kind, int detail) {
    const SimpleBlade blade = simple_blade(kind);
    if (detail >= 3)
        return toothed(blade, blade.teeth, blade.tooth_depth);
    if (detail == 2)
        return blade.teeth > 9 ? smooth(blade, 10) : toothed(blade, blade.teeth, blade.tooth_depth);
    HalfOutline half = {{0, 0}};
    if (detail == 1) {
        for (const float y : blade.coarse_heights)
            half.push_back({half_width_at(blade.curve, y), y});
    } else {
        const auto widest = std::max_element(blade.curve.begin(), blade.curve.end(),
                                             [](const glm::vec2& a, const glm::vec2& b) { return a.x < b.x; });
        half.push_back(*widest);
    }
    half.push_back({0, 1});
    return half;
}

HalfOutline oak_outline(int detail) {
    switch (detail) {
    case 0:
        return {{0, 0}, {0.5f, 0.6f}, {0, 1}};
    case 1: // base, lower lobe, bay, widest lobe, shoulder, tip
        return {{0, 0}, {0.34f, 0.36f}, {0.25f, 0.50f}, {0.5f, 0.70f}, {0.34f, 0.91f}, {0, 1}};
    case 2: { // two rows on every lobe, one in every bay
        HalfOutline half = {{0, 0}};
        for (const float y : {0.125f, 0.21f, 0.29f, 0.375f, 0.46f, 0.54f, 0.625f, 0.71f, 0.79f, 0.875f, 0.94f})
            half.push_back({oak_half_width(y), y});
        half.push_back({0, 1});
        return half;
    }
    default: {
        HalfOutline half = {{0, 0}};
        for (int i = 1; i < 128; ++i) {
            const float y = float(i) / 128;
            half.push_back({std::max(oak_half_width(y), y < 0.2f ? 0.012f : 0.f), y});
        }
        half.push_back({0, 1});
        return half;
    }
    }
}

/// A Norway maple's (Acer platanoides) five lobes, each drawn out to a point, with few large teeth; heart-shaped at the
/// base.
HalfOutline maple_outline(int detail) {
    switch (detail) {
    case 0:
        return {{0, 0.08f}, {0.5f, 0.55f}, {0, 1}};
    case 1: // base, basal lobe, bay, side lobe, bay, shoulder of the middle lobe, tip
        return {{0, 0.08f},    {0.14f, 0.01f},   {0.42f, 0.14f},  {0.29f, 0.33f},
                {0.5f, 0.64f}, {0.165f, 0.585f}, {0.165f, 0.79f}, {0, 1}};
    default:
        return {{0, 0.08f},       {0.045f, 0.03f},  {0.13f, 0},       {0.22f, 0.035f}, {0.31f, 0.055f},
                {0.43f, 0.12f},   {0.355f, 0.17f},  {0.36f, 0.235f},  {0.315f, 0.26f}, {0.285f, 0.32f},
                {0.36f, 0.375f},  {0.455f, 0.405f}, {0.425f, 0.47f},  {0.5f, 0.65f},   {0.385f, 0.615f},
                {0.325f, 0.695f}, {0.285f, 0.63f},  {0.175f, 0.56f},  {0.135f, 0.6f},  {0.145f, 0.7f},
                {0.215f, 0.80f},  {0.125f, 0.82f},  {0.085f, 0.885f}, {0.05f, 0.92f},  {0, 1}};
    }
}

HalfOutline make_outline(LeafKind kind, int detail) {
    if (has_needles(kind))
        throw std::logic_error("leaf outline: conifers have sprays");
    return kind == LeafKind::oak     ? oak_outline(detail)
           : kind == LeafKind::maple ? maple_outline(detail)
                                     : simple_outline(kind, detail);
}

} // namespace

const std::vector<std::string>& leaf_kind_names() {
    static const std::vector<std::string> names = {"oak",   "beech", "birch",  "maple",   "willow",
                                                   "aspen", "pine",  "spruce", "cypress", "cherry"};
    return names;
}

bool has_needles(LeafKind kind) {
    return kind == LeafKind::pine || kind == LeafKind::spruce || kind == LeafKind::cypress;
}

const HalfOutline& half_outline(LeafKind kind, int detail) {
    static const std::vector<std::array<HalfOutline, 4>> outlines = [] {
        std::vector<std::array<HalfOutline, 4>> all(leaf_kind_names().size());
        for (std::size_t k = 0; k < all.size(); ++k)
            for (int d = 0; d < 4 && !has_needles(LeafKind(k)); ++d)
                all[k][std::size_t(d)] = make_outline(LeafKind(k), d);
        return all;
    }();
    return outlines.at(std::size_t(kind))[std::size_t(std::clamp(detail, 0, 3))];
}

const HalfOutline& mask_outline(LeafKind kind) {
    return half_outline(kind, 3);
}

double outline_area(const HalfOutline& half) {
    double twice = 0; // of the half: the midrib, x = 0, adds nothing
    for (std::size_t i = 0; i + 1 < half.size(); ++i)
        twice += double(half[i].x) * half[i + 1].y - double(half[i + 1].x) * half[i].y;
    return twice;
}

Venation venation(LeafKind kind) {
    switch (kind) {
    case LeafKind::beech:
        return {7, 0.75f, false};
    case LeafKind::birch:
        return {6, 0.6f, false};
    case LeafKind::maple:
        return {0, 0, true};
    case LeafKind::willow:
        return {14, 0.3f, false};
    case LeafKind::aspen:
        return {5, 0.8f, false};
    case LeafKind::cherry:
        return {9, 0.45f, false};
    default:
        return {4, 0.55f, false}; // the oak: one into each lobe
    }
}

} // namespace kokage
