#include "reflection/maps/texel_codes.h"

#include <Eigen/Core>
#include <gtest/gtest.h>

namespace kokage {
namespace {

TEST(TexelCodes, HalvesAreEigens) {
    for (std::uint32_t bits = 0; bits < 0xffffffffu - 977; bits += 977) {
        const float value = std::bit_cast<float>(bits);
        if (!(std::abs(value) < 65520))
            continue;
        ASSERT_EQ(half_from_float(value), Eigen::half(value).x) << value;
    }
    for (std::uint32_t code = 0; code < 65536; ++code) {
        const float wanted = float(Eigen::numext::bit_cast<Eigen::half>(std::uint16_t(code)));
        const float got = float_from_half(std::uint16_t(code));
        if (std::isnan(wanted)) {
            EXPECT_TRUE(std::isnan(got));
        } else {
            EXPECT_EQ(std::bit_cast<std::uint32_t>(got), std::bit_cast<std::uint32_t>(wanted)) << code;
            EXPECT_EQ(half_from_float(got), std::isinf(got) ? (got > 0 ? 0x7bff : 0xfbff) : int(code));
        }
    }
    EXPECT_EQ(float_from_half(half_from_float(1e30f)), kLargestHalf);
    EXPECT_EQ(float_from_half(half_from_float(-1e5f)), -kLargestHalf);
}

TEST(TexelCodes, SharedExponentsAreWithinHalfAStepOfTheLargestChannel) {
    std::uint32_t random = 1;
    auto next = [&] { return float((random = random * 1664525u + 1013904223u) >> 8) / float(1 << 24); };
    for (int i = 0; i < 200000; ++i) {
        const float scale = std::exp2(next() * 31 - 15);
        const glm::vec3 rgb(next() * scale, next() * scale, next() * scale);
        const glm::vec3 back = rgb_from_shared_exponent(shared_exponent_from_rgb(rgb));
        const float largest = std::max({rgb.r, rgb.g, rgb.b});
        const float step = std::exp2(std::max(std::floor(std::log2(largest)), -16.f) + 1 - 9);
        for (int c = 0; c < 3; ++c)
            ASSERT_NEAR(back[c], rgb[c], step * 1.0001f) << largest;
        const bool next_exponent = largest > 0.99f * std::exp2(std::floor(std::log2(largest)) + 1);
        for (int c = 0; c < 3 && !next_exponent; ++c)
            ASSERT_NEAR(back[c], rgb[c], step * 0.5001f) << largest;
    }
    for (const float edge : {0.f, 511.6f / 512, 1.f, 0x1p-24f, 65408.f})
        EXPECT_NEAR(rgb_from_shared_exponent(shared_exponent_from_rgb(glm::vec3(edge))).g, edge, edge / 511 + 1e-12f);
    EXPECT_EQ(rgb_from_shared_exponent(shared_exponent_from_rgb({1e30f, -5, 1})).r, kLargestSharedExponent);
    EXPECT_EQ(rgb_from_shared_exponent(shared_exponent_from_rgb({1, -5, 1})).g, 0);
    // 1, 0.5 and 0.25: OpenGL's EXT_texture_shared_exponent: mantissas 256, 128, 64 and biased exponent 16.
    EXPECT_EQ(shared_exponent_from_rgb({1, 0.5f, 0.25f}), 256u | 128u << 9 | 64u << 18 | 16u << 27);
}

} // namespace
} // namespace kokage
