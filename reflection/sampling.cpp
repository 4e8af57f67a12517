#include "reflection/sampling.h"
#include "common/services/random.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace kokage {
namespace {

constexpr float kBelowOne = 0x1.fffffep-1f;

// Kensler 2013, listing 3: a permutation of 0 … length-1 by hashing and cycle walking.
std::uint32_t permute(std::uint32_t i, std::uint32_t length, std::uint32_t p) {
    std::uint32_t w = length - 1;
    w |= w >> 1;
    w |= w >> 2;
    w |= w >> 4;
    w |= w >> 8;
    w |= w >> 16;
    do {
        i ^= p;
        i *= 0xe170893du;
        i ^= p >> 16;
        i ^= (i & w) >> 4;
        i ^= p >> 8;
        i *= 0x0929eb3fu;
        i ^= p >> 23;
        i ^= (i & w) >> 1;
        i *= 1u | p >> 27;
        i *= 0x6935fa69u;
        i ^= (i & w) >> 11;
        i *= 0x74dcb303u;
        i ^= (i & w) >> 2;
        i *= 0x9e501cc3u;
        i ^= (i & w) >> 2;
        i *= 0xc860a3dfu;
        i &= w;
        i ^= i >> 5;
    } while (i >= length);
    return (i + p) % length;
}

// Kensler 2013, listing 4.
float hashed_uniform(std::uint32_t i, std::uint32_t p) {
    i ^= p;
    i ^= i >> 17;
    i ^= i >> 10;
    i *= 0xb36534e5u;
    i ^= i >> 12;
    i ^= i >> 21;
    i *= 0x93fc4795u;
    i ^= 0xdf6e307fu;
    i ^= i >> 17;
    i *= 1u | p >> 18;
    return float(i >> 8) * 0x1p-24f;
}

// Inverse of the Blackman-Harris window's distribution function at 1025 even steps.
constexpr int kFilterSteps = 1024;
constexpr double kFilterRadius = 1.5;

std::array<float, kFilterSteps + 1> make_filter_table() {
    // Distribution function of 0.35875 - 0.48829 cos 2πx + 0.14128 cos 4πx - 0.01168 cos 6πx on [0,1], normalised.
    auto distribution = [](double x) {
        const double w = 2 * kPiDouble;
        return x + (-0.48829 * std::sin(w * x) / w + 0.14128 * std::sin(2 * w * x) / (2 * w) -
                    0.01168 * std::sin(3 * w * x) / (3 * w)) /
                       0.35875;
    };
    std::array<float, kFilterSteps + 1> table{};
    for (int i = 0; i <= kFilterSteps; ++i) {
        double low = 0, high = 1;
        for (int k = 0; k < 50; ++k) {
            const double middle = 0.5 * (low + high);
            (distribution(middle) < double(i) / kFilterSteps ? low : high) = middle;
        }
        table[std::size_t(i)] = float((low + high - 1) * kFilterRadius);
    }
    return table;
}

} // namespace

glm::vec2 multi_jittered(std::uint32_t index, std::uint32_t count, std::uint32_t pattern) {
    // Kensler 2013, listing 5: rows and columns from the count, so that any count works.
    const auto columns = std::max(1u, std::uint32_t(std::sqrt(float(count))));
    const std::uint32_t rows = (count + columns - 1) / columns;
    index = permute(index, count, pattern * 0x51633e2du);
    const std::uint32_t sx = permute(index % columns, columns, pattern * 0x68bc21ebu);
    const std::uint32_t sy = permute(index / columns, rows, pattern * 0x02e5be93u);
    const float jx = hashed_uniform(index, pattern * 0x967a889bu), jy = hashed_uniform(index, pattern * 0x368cc8b7u);
    return {std::min(kBelowOne, (float(sx) + (float(sy) + jx) / float(rows)) / float(columns)),
            std::min(kBelowOne, (float(index) + jy) / float(count))};
}

glm::vec2 evenly_spread(std::uint32_t index, std::uint32_t pattern) {
    // 1/g and 1/g^2 times 2^32, where g^3 = g + 1.
    const std::uint32_t x = std::uint32_t(hash64(pattern)) + index * 3242174889u,
                        y = std::uint32_t(hash64(pattern) >> 32) + index * 2447445414u;
    return {float(x >> 8) * 0x1p-24f, float(y >> 8) * 0x1p-24f};
}

float stratified(std::uint32_t index, std::uint32_t count, std::uint32_t pattern) {
    const std::uint32_t stratum = permute(index, count, pattern * 0x51633e2du);
    return std::min(kBelowOne, (float(stratum) + hashed_uniform(stratum, pattern * 0x967a889bu)) / float(count));
}

std::uint32_t place_on_curve(std::uint32_t x, std::uint32_t y) {
    const auto spread = [](std::uint32_t bits) {
        bits &= 0xffffu;
        bits = (bits | bits << 8) & 0x00ff00ffu;
        bits = (bits | bits << 4) & 0x0f0f0f0fu;
        bits = (bits | bits << 2) & 0x33333333u;
        return (bits | bits << 1) & 0x55555555u;
    };
    return spread(x) | spread(y) << 1;
}

glm::vec3 cosine_direction(glm::vec2 u) {
    const glm::vec2 square = 2.f * u - 1.f;
    float radius = 0, angle = 0;
    if (std::abs(square.x) > std::abs(square.y)) {
        radius = square.x;
        angle = kPi / 4 * (square.y / square.x);
    } else if (square.y != 0) {
        radius = square.y;
        angle = kPi / 2 - kPi / 4 * (square.x / square.y);
    }
    const float x = radius * std::cos(angle), z = radius * std::sin(angle);
    return {x, std::sqrt(std::max(0.f, 1 - radius * radius)), z};
}

float pixel_filter_offset(float u) {
    static const std::array<float, kFilterSteps + 1> table = make_filter_table();
    const float place = std::clamp(u, 0.f, 1.f) * kFilterSteps;
    const auto step = std::min(std::size_t(place), std::size_t(kFilterSteps - 1));
    const float fraction = place - float(step);
    return (1 - fraction) * table[step] + fraction * table[step + 1];
}

float pixel_filter(float offset) {
    constexpr int kSteps = 512;
    static const std::array<float, kSteps + 2> table = [] {
        std::array<float, kSteps + 2> values{};
        for (int i = 0; i <= kSteps; ++i) {
            const double turn = kPiDouble * (1 + double(i) / kSteps); // from the middle of the window to its end
            values[std::size_t(i)] = float(
                (0.35875 - 0.48829 * std::cos(turn) + 0.14128 * std::cos(2 * turn) - 0.01168 * std::cos(3 * turn)) /
                (0.35875 * 2 * kFilterRadius));
        }
        return values;
    }();
    const float place = std::abs(offset) * float(kSteps / kFilterRadius);
    if (!(place < kSteps))
        return 0;
    const auto step = std::size_t(place);
    const float fraction = place - float(step);
    return (1 - fraction) * table[step] + fraction * table[step + 1];
}

glm::vec4 cubic_b_spline(float t) {
    const float s = 1 - t;
    return glm::vec4(s * s * s, 3 * t * t * t - 6 * t * t + 4, 3 * s * s * s - 6 * s * s + 4, t * t * t) / 6.f;
}

} // namespace kokage
