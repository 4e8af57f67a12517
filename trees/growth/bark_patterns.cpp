#include "trees/growth/bark_patterns.h"

#include "trees/growth/tiling_noise.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace kokage {
namespace {

/// Noise that repeats with the tile: nx and ny cells in it.
float noise(const glm::vec2& uv, int nx, int ny, std::uint64_t seed) {
    return tiling_noise(uv.x * float(nx), uv.y * float(ny), nx, ny, seed);
}

float smooth_step(float low, float high, float x) {
    const float t = std::clamp((x - low) / (high - low), 0.f, 1.f);
    return t * t * (3 - 2 * t);
}

/// Ridges along the stem that wander, split and join: 0 in a fissure, 1 on a ridge. `ridges` of them around, broken
/// `breaks` times along.
float fissures(const glm::vec2& uv, int ridges, int breaks, float wander, std::uint64_t seed) {
    const float bend = 0.9f * noise(uv, 5, 4, seed) + 0.45f * noise(uv, 12, 9, seed + 1);
    const float stripes = std::abs(std::sin(kPi * (float(ridges) * uv.x + bend * wander)));
    const float cross = std::abs(
        std::sin(kPi * (float(breaks) * uv.y + 2.2f * noise(uv, ridges, std::max(1, breaks / 2 + 1), seed + 2))));
    return std::min(std::pow(stripes, 0.6f), 0.35f + 0.65f * std::pow(cross, 0.35f));
}

} // namespace

const std::vector<std::string>& bark_kind_names() {
    static const std::vector<std::string> names = {"oak",   "beech", "birch",  "maple",   "willow",
                                                   "aspen", "pine",  "spruce", "cypress", "cherry"};
    return names;
}

BarkPattern::BarkPattern(BarkKind kind, float age) : kind_(kind), age_(age), bands_(band_count) {
    if (kind == BarkKind::birch)
        scatter(0, 46, {0.015f, 0.003f}, {0.11f, 0.0075f}, 61);
    else if (kind == BarkKind::aspen)
        scatter(9, 42, {0.012f, 0.014f}, {0.026f, 0.028f}, 62);
    else if (kind == BarkKind::cherry)
        scatter(11, 66, {0.03f, 0.004f}, {0.10f, 0.010f}, 63);
}

/// In rows around the stem, or anywhere (0 rows).
void BarkPattern::scatter(int rows, int count, glm::vec2 smallest, glm::vec2 largest, std::uint64_t seed) {
    for (int i = 0; i < count; ++i) {
        Random random(seed, std::uint64_t(i));
        const float size = random.uniform() * random.uniform();
        Lenticel mark;
        mark.half_size = {glm::mix(smallest.x, largest.x, size), glm::mix(smallest.y, largest.y, std::sqrt(size))};
        mark.centre = {random.uniform(), random.uniform()};
        if (rows > 0)
            mark.centre.y = (float(i % rows) + random.uniform(0.35f, 0.65f)) / float(rows);
        const int low = int(std::floor((mark.centre.y - 1.3f * mark.half_size.y) * band_count)),
                  high = int(std::floor((mark.centre.y + 1.3f * mark.half_size.y) * band_count));
        for (int band = low; band <= high; ++band)
            bands_[std::size_t(wrapped_cell(band, band_count))].push_back(std::uint32_t(lenticels_.size()));
        lenticels_.push_back(mark);
    }
}

float BarkPattern::lenticel(const glm::vec2& uv, LenticelShape shape) const {
    float strongest = 0;
    const int band = std::min(band_count - 1, int(uv.y * band_count));
    for (const std::uint32_t i : bands_[std::size_t(band)]) {
        const Lenticel& mark = lenticels_[i];
        glm::vec2 d = uv - mark.centre;
        d = glm::abs(d - glm::round(d)) / mark.half_size; // the nearest of its copies
        const float r = shape == LenticelShape::diamond ? d.x + d.y : std::max(d.x * d.x + d.y * d.y, 0.9f * d.y);
        strongest = std::max(strongest, 1 - smooth_step(0.75f, 1.15f, r));
    }
    return strongest;
}

BarkPattern::Point BarkPattern::oak(glm::vec2 uv) const {
    const float ridge = fissures(uv, 9, 5, 1.6f, 21);
    const float grain = noise(uv, 64, 24, 24), lichen = noise(uv, 7, 7, 25);
    const float light = std::max(0.08f, 0.28f + 0.8f * ridge + 0.35f * (grain - 0.5f));
    const glm::vec3 tint =
        glm::mix(glm::vec3(1.f, 0.95f, 0.9f), glm::vec3(0.88f, 1.f, 0.86f), std::clamp(3 * (lichen - 0.6f), 0.f, 1.f));
    return {ridge + 0.12f * grain, light * tint};
}

/// Smooth: faint clouds, wrinkles around the stem, lichen.
BarkPattern::Point BarkPattern::beech(glm::vec2 uv) const {
    const float clouds = 0.5f * noise(uv, 4, 3, 31) + 0.3f * noise(uv, 9, 7, 32) + 0.2f * noise(uv, 21, 17, 33);
    const float wrinkle = std::abs(std::sin(kPi * (22 * uv.y + 2.5f * noise(uv, 4, 6, 34)))),
                grain = noise(uv, 90, 90, 35);
    const float fold = smooth_step(0.45f, 0.75f, noise(uv, 5, 9, 36)) * (1 - smooth_step(0.f, 0.3f, wrinkle));
    const float lichen = smooth_step(
        0.60f, 0.78f, 0.45f * noise(uv, 5, 5, 37) + 0.3f * noise(uv, 13, 12, 38) + 0.25f * noise(uv, 37, 34, 30));
    const glm::vec3 tint = glm::mix(glm::vec3(1.f, 0.99f, 0.92f), glm::vec3(0.93f, 1.05f, 0.88f), noise(uv, 3, 3, 39));
    return {clouds - 0.5f * fold + 0.15f * grain,
            (0.78f + 0.4f * (clouds - 0.5f) + 0.1f * (grain - 0.5f) - 0.22f * fold + 0.16f * lichen) * tint};
}

/// White with dark lenticels across; at an old foot black, corky and split.
BarkPattern::Point BarkPattern::birch(glm::vec2 uv) const {
    const float bands = noise(uv, 3, 44, 41), clouds = noise(uv, 4, 5, 42),
                peel = smooth_step(0.68f, 0.74f, noise(uv, 3, 14, 43));
    const float mark = lenticel(uv, LenticelShape::dash);
    glm::vec3 color = (0.84f + 0.16f * bands + 0.1f * (clouds - 0.5f)) * glm::vec3(1.f, 0.975f, 0.93f);
    color = glm::mix(color, glm::vec3(0.86f, 0.72f, 0.60f), 0.55f * peel);
    color = glm::mix(color, glm::vec3(0.13f, 0.115f, 0.10f), 0.92f * mark);
    float height = 0.3f + 0.05f * bands + 0.06f * peel - 0.1f * mark;
    // Black rough diamonds that join as the stem grows old.
    const float spread = 0.55f * noise(uv, 4, 2, 44) + 0.3f * noise(uv, 9, 5, 45) + 0.15f * noise(uv, 24, 16, 46);
    const float cork = smooth_step(0.f, 0.07f, spread - (0.98f - 0.78f * age_));
    const float ridge = fissures(uv, 8, 7, 1.8f, 47), grain = noise(uv, 50, 36, 48);
    color = glm::mix(color, (0.10f + 0.16f * ridge + 0.08f * (grain - 0.5f)) * glm::vec3(1.f, 0.93f, 0.86f), cork);
    height = glm::mix(height, 0.25f + 0.75f * ridge + 0.1f * grain, cork);
    return {height, color};
}

/// Fine shallow ridges that form a net.
BarkPattern::Point BarkPattern::maple(glm::vec2 uv) const {
    const float ridge = fissures(uv, 16, 6, 2.6f, 51), fine = fissures(uv, 31, 9, 2.2f, 54),
                grain = noise(uv, 70, 40, 57);
    const float height = 0.7f * ridge + 0.3f * fine;
    const float light = 0.5f + 0.5f * height + 0.22f * (grain - 0.5f);
    return {height + 0.1f * grain,
            light * glm::mix(glm::vec3(1.f, 0.93f, 0.84f), glm::vec3(0.93f, 1.f, 0.88f), noise(uv, 5, 6, 58))};
}

/// Coarse ridges that cross: diamonds between them.
BarkPattern::Point BarkPattern::willow(glm::vec2 uv) const {
    const float bend = 0.8f * noise(uv, 4, 4, 71) + 0.35f * noise(uv, 11, 9, 72);
    const float right = std::abs(std::sin(kPi * (7 * uv.x + 2 * uv.y + 1.3f * bend))),
                left = std::abs(std::sin(kPi * (7 * uv.x - 2 * uv.y - 1.1f * bend + 0.37f)));
    const float ridge = std::pow(std::max(1 - right, 1 - left), 0.75f), grain = noise(uv, 60, 22, 73);
    const float light = 0.22f + 0.85f * ridge + 0.35f * (grain - 0.5f);
    return {ridge + 0.15f * grain,
            std::max(0.08f, light) * glm::mix(glm::vec3(1.f, 0.90f, 0.76f), glm::vec3(1.f, 0.97f, 0.88f), ridge)};
}

/// Smooth and greenish, with dark diamonds in rows; at an old foot dark and furrowed.
BarkPattern::Point BarkPattern::aspen(glm::vec2 uv) const {
    const float clouds = 0.6f * noise(uv, 4, 4, 81) + 0.4f * noise(uv, 11, 13, 82), grain = noise(uv, 80, 60, 83);
    const float mark = lenticel(uv, LenticelShape::diamond);
    glm::vec3 color = (0.8f + 0.35f * (clouds - 0.5f) + 0.1f * (grain - 0.5f)) *
                      glm::mix(glm::vec3(1.f, 1.f, 0.72f), glm::vec3(1.f, 1.f, 0.86f), noise(uv, 3, 5, 84));
    color = glm::mix(color, glm::vec3(0.16f, 0.145f, 0.11f), 0.9f * mark);
    float height = 0.35f + 0.1f * clouds + 0.18f * mark;
    const float spread = 0.6f * noise(uv, 5, 2, 85) + 0.4f * noise(uv, 10, 6, 86);
    const float furrowed = smooth_step(0.f, 0.12f, spread - (0.98f - 0.85f * age_));
    const float ridge = fissures(uv, 8, 4, 1.7f, 87);
    color = glm::mix(color, (0.14f + 0.3f * ridge + 0.12f * (grain - 0.5f)) * glm::vec3(1.f, 0.95f, 0.80f), furrowed);
    height = glm::mix(height, 0.15f + 0.85f * ridge, furrowed);
    return {height, color};
}

/// Orange papery flakes above; thick brown plates between dark cracks at an old foot.
BarkPattern::Point BarkPattern::pine(glm::vec2 uv) const {
    const glm::vec2 bent = uv + 0.05f * glm::vec2(noise(uv, 6, 6, 91), noise(uv, 6, 6, 92));
    // Thin flakes, one on the other: the highest of three shingles.
    float flake_height = 0, flake_tone = 0.5f;
    for (int layer = 0; layer < 2; ++layer) {
        const TilingCell cell = tiling_cells(bent.x * 7, bent.y * 11, 7, 11, std::uint64_t(93 + layer));
        const float height = cell.value * smooth_step(0.02f, 0.10f, cell.second - cell.nearest);
        if (height > flake_height) {
            flake_height = height;
            flake_tone = cell.value;
        }
    }
    const float grain = noise(uv, 70, 50, 95);
    const glm::vec3 papery = (0.72f + 0.35f * (flake_height - 0.4f) + 0.25f * (grain - 0.5f)) *
                             glm::mix(glm::vec3(1.f, 0.50f, 0.20f), glm::vec3(0.95f, 0.60f, 0.34f), flake_tone);
    // Plates, themselves layered.
    const glm::vec2 torn = uv + glm::vec2(0.06f, 0.16f) * glm::vec2(noise(uv, 6, 6, 91), noise(uv, 7, 4, 99));
    const TilingCell plate = tiling_cells(torn.x * 7, torn.y * 4, 7, 4, 96);
    const float gap = plate.second - plate.nearest, on_plate = smooth_step(0.02f, 0.15f, gap);
    const float layers = std::floor(4 * (0.6f * noise(uv, 14, 9, 97) + 0.4f * flake_height)) / 4;
    const float plate_height = on_plate * (0.55f + 0.25f * plate.value + 0.2f * layers);
    const glm::vec3 brown = (0.32f + 0.46f * plate_height + 0.18f * (grain - 0.5f)) *
                            glm::mix(glm::vec3(1.f, 0.66f, 0.47f), glm::vec3(1.f, 0.84f, 0.70f), layers);
    // Among the flakes stand as many plates as the age says, faint ones at first.
    const float old = plate.value < age_ ? 0.35f + 0.65f * age_ : 0.f;
    return {glm::mix(0.5f + 0.15f * flake_height, plate_height, old), glm::mix(papery, 0.8f * brown, old)};
}

/// Small round scales whose edges lift.
BarkPattern::Point BarkPattern::spruce(glm::vec2 uv) const {
    const glm::vec2 bent = uv + 0.02f * glm::vec2(noise(uv, 9, 9, 101), noise(uv, 9, 9, 102));
    const TilingCell cell = tiling_cells(bent.x * 12, bent.y * 10, 12, 10, 103);
    const float edge = smooth_step(0.02f, 0.16f, cell.second - cell.nearest), grain = noise(uv, 80, 70, 104);
    const float height = edge * (0.45f + 0.35f * cell.value + 0.25f * cell.nearest);
    const float light = 0.32f + 0.75f * height + 0.25f * (grain - 0.5f);
    return {height, light * glm::mix(glm::vec3(1.f, 0.68f, 0.50f), glm::vec3(1.f, 0.90f, 0.80f), cell.value)};
}

/// Long fibrous strips.
BarkPattern::Point BarkPattern::cypress(glm::vec2 uv) const {
    const float bend = 1.5f * noise(uv, 3, 2, 111);
    const float strips = std::abs(std::sin(kPi * (15 * uv.x + uv.y + bend + 0.5f * noise(uv, 20, 3, 112))));
    const float fibre = noise(uv, 110, 5, 113), broken = noise(uv, 18, 6, 114);
    const float height = std::pow(strips, 0.5f) * (0.6f + 0.4f * broken) + 0.2f * fibre;
    const float light = 0.35f + 0.55f * height + 0.25f * (fibre - 0.5f);
    return {height, light * glm::mix(glm::vec3(1.f, 0.60f, 0.42f), glm::vec3(1.f, 0.86f, 0.72f),
                                     smooth_step(0.3f, 0.9f, height))};
}

/// Satin, striped around the stem, with rows of corky lenticels.
BarkPattern::Point BarkPattern::cherry(glm::vec2 uv) const {
    const float stripes = 0.6f * noise(uv, 2, 60, 121) + 0.4f * noise(uv, 5, 24, 122), clouds = noise(uv, 3, 4, 123);
    const float mark = lenticel(uv, LenticelShape::dash);
    glm::vec3 color = (0.62f + 0.45f * (stripes - 0.5f) + 0.35f * (clouds - 0.5f)) *
                      glm::mix(glm::vec3(1.f, 0.55f, 0.42f), glm::vec3(0.95f, 0.70f, 0.62f), clouds);
    color = glm::mix(color, (0.9f + 0.3f * (stripes - 0.5f)) * glm::vec3(1.25f, 0.92f, 0.66f), 0.85f * mark);
    // Where it peels around the stem it is rough and dark.
    const float crack = age_ * smooth_step(0.66f, 0.74f, 0.6f * noise(uv, 4, 26, 124) + 0.4f * noise(uv, 17, 52, 125));
    return {0.35f + 0.12f * stripes + 0.6f * mark - 0.3f * crack, color * (1 - 0.45f * crack)};
}

BarkPattern::Point BarkPattern::at(const glm::vec2& uv) const {
    switch (kind_) {
    case BarkKind::oak:
        return oak(uv);
    case BarkKind::beech:
        return beech(uv);
    case BarkKind::birch:
        return birch(uv);
    case BarkKind::maple:
        return maple(uv);
    case BarkKind::willow:
        return willow(uv);
    case BarkKind::aspen:
        return aspen(uv);
    case BarkKind::pine:
        return pine(uv);
    case BarkKind::spruce:
        return spruce(uv);
    case BarkKind::cypress:
        return cypress(uv);
    case BarkKind::cherry:
        return cherry(uv);
    }
    throw std::logic_error("bark: no such kind");
}

} // namespace kokage
