#include "trees/growth/spray.h"

#include "common/services/random.h"
#include "trees/growth/directions.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

/// A segment in the plane x-y.
SpraySegment in_plane(const glm::vec2& base, const glm::vec2& tip, float half_width) {
    SpraySegment segment;
    segment.base = {base.x, base.y, 0};
    segment.tip = {tip.x, tip.y, 0};
    segment.across = unit_or(glm::cross(segment.tip - segment.base, glm::vec3(0, 0, 1)), {1, 0, 0});
    segment.half_width = half_width;
    return segment;
}

/// Turned about the spray's axis by `angle`.
glm::vec3 turned(const glm::vec3& v, float angle) {
    const float c = std::cos(angle), s = std::sin(angle);
    return {c * v.x + s * v.z, v.y, -s * v.x + c * v.z};
}
SpraySegment turned(SpraySegment segment, float angle) {
    segment.base = turned(segment.base, angle);
    segment.tip = turned(segment.tip, angle);
    segment.across = turned(segment.across, angle);
    return segment;
}

/// The second half: the first one turned by a right angle, without the axis.
Spray crossed(std::vector<SpraySegment> half) {
    Spray spray;
    spray.first_half = half.size();
    spray.segments = std::move(half);
    for (std::size_t i = 0; i < spray.first_half; ++i)
        if (!spray.segments[i].is_wood)
            spray.segments.push_back(turned(spray.segments[i], kPi / 2));
    return spray;
}

SpraySegment axis_to(float y, float half_width) {
    SpraySegment axis = in_plane({0, 0}, {0, y}, half_width);
    axis.is_wood = true;
    return axis;
}

/// A needle of `length` from the axis at height y, at `angle` from it; keeps within the spray's box.
SpraySegment needle(float y, float side, float angle, float length, float width, float half_width) {
    const glm::vec2 direction{side * std::sin(angle), std::cos(angle)};
    float scale = length;
    if (direction.x != 0)
        scale = std::min(scale, (0.5f * width - half_width) / std::abs(direction.x));
    if (direction.y > 0)
        scale = std::min(scale, (1 - y) / direction.y);
    return in_plane({0, y}, glm::vec2(0, y) + std::max(scale, 0.02f) * direction, half_width);
}

/// Needles stand left and right of the axis in turn. Where the i-th of `count` does: 0 at the foot, 1 at the tip.
struct NeedlePlace {
    float t, side;
};
NeedlePlace needle_place(int i, int count) {
    return {(float(i) + 0.5f) / float(count), i % 2 == 0 ? 1.f : -1.f};
}

} // namespace

Spray pine_spray(int needles, float width) {
    // Angles as on shoots in their first summers; needles 1.2 to 1.8 mm wide at 4 to 7 cm (Farjon, A Handbook of the
    // World's Conifers, 2010): width 1/40 of the length.
    const int pairs = std::max(1, needles / 4);
    const float length = 0.5f * width / std::sin(radians(50));
    std::vector<SpraySegment> half = {axis_to(std::max(0.1f, 1 - 0.75f * length), 0.016f)};
    for (int i = 0; i < pairs; ++i) {
        Random random(41, std::uint64_t(i));
        const auto [t, side] = needle_place(i, pairs);
        const float y = (1 - 0.8f * length) * (0.12f + 0.88f * t);
        const float angle = radians(62) - radians(40) * t * t + random.uniform(-0.12f, 0.12f), spread = 0.10f;
        for (const float away : {-spread, spread}) {
            const float own = length * random.uniform(0.88f, 1.f);
            half.push_back(turned(needle(y, side, std::max(0.06f, angle + away), own, width, own / 80),
                                  random.uniform(-0.5f, 0.5f)));
        }
    }
    return crossed(std::move(half));
}

Spray spruce_spray(int needles, float width) {
    // Picea abies: needles 10 to 25 mm long, about 1 to 1.5 mm wide (Farjon 2010): width 1/14 of the length.
    const int count = std::max(1, needles / 2);
    const float length = 0.5f * width / std::sin(radians(52));
    std::vector<SpraySegment> half = {axis_to(std::max(0.1f, 1 - 0.8f * length), 0.013f)};
    for (int i = 0; i < count; ++i) {
        Random random(43, std::uint64_t(i));
        const auto [t, side] = needle_place(i, count);
        const float y = (1 - 0.85f * length) * t;
        const float angle = radians(64) - radians(30) * t * t * t + random.uniform(-0.15f, 0.15f);
        const float own =
            length * (0.75f + 0.25f * std::sin(kPi * std::min(1.f, 0.2f + 0.8f * t))) * random.uniform(0.9f, 1.f);
        half.push_back(turned(needle(y, side, i + 1 == count ? 0.05f : angle, own, width, length / 28),
                              random.uniform(-0.6f, 0.6f)));
    }
    return crossed(std::move(half));
}

Spray cypress_spray(int twigs, float width) {
    // Cupressus sempervirens: the finest twigs are about 1 mm thick (Farjon 2010), of a spray about 9 cm long.
    const int branches = std::max(1, int(std::lround(std::sqrt(double(std::max(twigs, 2)) * 0.9))));
    const int finest = std::max(1, twigs / (2 * branches));
    std::vector<SpraySegment> half;
    SpraySegment axis = axis_to(0.97f, 0.009f);
    axis.is_wood = false; // green, as all of it
    half.push_back(axis);
    for (int i = 0; i < branches; ++i) {
        Random random(47, std::uint64_t(i));
        const float t = (float(i) + 0.6f) / float(branches), y = 0.06f + 0.8f * t, side = i % 2 == 0 ? 1.f : -1.f;
        const float angle = radians(42) - radians(12) * t + random.uniform(-0.1f, 0.1f);
        const float length = 0.5f * width / std::sin(radians(42)) * (1 - 0.65f * t * t) * random.uniform(0.8f, 1.f);
        const SpraySegment branch = needle(y, side, angle, length, width, 0.0075f);
        const float turn = random.uniform(-0.5f, 0.5f);
        half.push_back(turned(branch, turn));
        for (int j = 0; j < finest; ++j) {
            const float s = (float(j) + 0.7f) / float(finest + 1), own = 0.55f * length * (1 - 0.6f * s);
            const glm::vec2 start = glm::mix(glm::vec2(branch.base), glm::vec2(branch.tip), s);
            const float bend = angle * side + (j % 2 == 0 ? 1.f : -1.f) * radians(40);
            const glm::vec2 end = start + own * glm::vec2(std::sin(bend), std::cos(bend));
            const glm::vec2 kept{std::clamp(end.x, -0.5f * width + 0.0075f, 0.5f * width - 0.0075f),
                                 std::clamp(end.y, 0.f, 0.995f)};
            half.push_back(turned(in_plane(start, kept, 0.0065f), turn));
        }
    }
    return crossed(std::move(half));
}

Spray cherry_blossom(float width) {
    // Prunus serrulata: corymbs of 3 to 5 flowers, 3 to 4 cm across (Flora of China 9, 2003): a radius of 0.2 of a
    // spray of 0.1 m.
    Spray spray;
    constexpr float radius = 0.2f;
    const float reach = std::max(0.02f, 0.5f * width - radius);
    const glm::vec3 centres[4] = {
        {-reach, 0.36f, 0.10f}, {reach, 0.45f, -0.12f}, {-0.7f * reach, 0.75f, -0.10f}, {0.8f * reach, 0.78f, 0.12f}};
    for (int f = 0; f < 4; ++f) {
        const glm::vec3 centre = centres[f];
        SpraySegment stalk;
        stalk.tip = centre;
        stalk.across = unit_or(glm::cross(centre, glm::vec3(0, 0, 1)), {1, 0, 0});
        stalk.half_width = 0.006f;
        stalk.is_wood = true;
        spray.segments.push_back(stalk);
        const glm::vec3 facing = unit_or(glm::vec3(0.35f * centre.x, 0.12f, 1.f), {0, 0, 1});
        const glm::vec3 x = unit_or(glm::cross(glm::vec3(0, 1, 0), facing), {1, 0, 0}), y = glm::cross(facing, x);
        for (int p = 0; p < 5; ++p) {
            const float angle = 2 * kPi * (float(p) + 0.3f * float(f)) / 5;
            SpraySegment petal;
            const glm::vec3 out = std::cos(angle) * x + std::sin(angle) * y;
            petal.base = centre;
            petal.tip = centre + radius * unit_or(out + 0.3f * facing, out);
            petal.across = unit_or(glm::cross(petal.tip - petal.base, facing), x);
            petal.half_width = 0.40f * radius;
            petal.is_petal = true;
            spray.segments.push_back(petal);
        }
    }
    spray.first_half = spray.segments.size(); // it faces one way: one card shows it
    return spray;
}

float longest_needle(const Spray& spray) {
    float longest = 0;
    for (const SpraySegment& segment : spray.segments)
        if (!segment.is_wood)
            longest = std::max(longest, glm::distance(segment.base, segment.tip));
    return longest;
}

} // namespace kokage
