// Texel formats against what they promise: the error of a rounded value, the ends of the range, exact values.
#include "reflection/maps/texel_format.h"

#include "common/services/error.h"
#include "common/services/random.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>

namespace kokage {
namespace {

glm::vec3 there_and_back(const glm::vec3& colour, TexelFormat format) {
    const auto bytes = packed_texels(std::vector{colour}, format);
    EXPECT_EQ(bytes.size(), texel_bytes(format));
    return unpacked_texel(bytes.data(), format);
}

TEST(TexelFormat, FloatsStayAsTheyAre) {
    const glm::vec3 colour(1e-30f, 0.1f, 1e30f);
    EXPECT_EQ(there_and_back(colour, TexelFormat::float_rgb), colour);
}

TEST(TexelFormat, EveryHalfComesBackAndHasTheBitsOfAnIeeeHalf) {
    for (unsigned bits = 0; bits < 0x7c00; ++bits) {
        const int exponent = int(bits >> 10), mantissa = int(bits & 1023);
        const float value =
            exponent == 0 ? std::ldexp(float(mantissa), -24) : std::ldexp(float(1024 + mantissa), exponent - 25);
        const auto bytes = packed_texels(std::vector{glm::vec3(value, -value, 0)}, TexelFormat::half_rgb);
        std::uint16_t halves[3];
        std::memcpy(halves, bytes.data(), 6);
        ASSERT_EQ(halves[0], bits);
        ASSERT_EQ(halves[1], bits | 0x8000u);
        ASSERT_EQ(unpacked_texel(bytes.data(), TexelFormat::half_rgb), glm::vec3(value, -value, 0)) << bits;
    }
}

TEST(TexelFormat, HalvesRoundToTheNearest) {
    Random random(1);
    for (int i = 0; i < 20000; ++i) {
        const float value = std::exp(40 * (random.uniform() - 0.6f));
        const float got = there_and_back(glm::vec3(value), TexelFormat::half_rgb).r;
        if (value <= 65504.f)
            ASSERT_LE(std::abs(got - value), std::max(value / 2048, 0x1p-25f)) << value;
        else
            ASSERT_EQ(got, 65504.f) << value;
    }
    EXPECT_EQ(there_and_back(glm::vec3(1 + 0x1p-11f, 1 + 3 * 0x1p-11f, 1e9f), TexelFormat::half_rgb),
              glm::vec3(1, 1 + 0x1p-9f, 65504)); // ties go to even
}

TEST(TexelFormat, SharedExponentsKeepNineBitsOfTheLargestChannel) {
    Random random(2);
    for (int i = 0; i < 20000; ++i) {
        const float scale = std::exp(30 * (random.uniform() - 0.6f));
        const float r = random.uniform(), g = random.uniform(), b = random.uniform();
        const glm::vec3 colour = glm::min(scale * glm::vec3(r, g, b), glm::vec3(65408.f));
        const glm::vec3 got = there_and_back(colour, TexelFormat::shared_exponent);
        const float largest = std::max({colour.r, colour.g, colour.b, 0x1p-15f});
        ASSERT_LE(glm::length(got - colour), 1.8f * largest / 512) << scale;
        for (int c = 0; c < 3; ++c)
            ASSERT_LE(std::abs(got[c] - colour[c]), largest / 511) << scale;
    }
    for (const glm::vec3& exact : {glm::vec3(0), glm::vec3(1, 0.5f, 0), glm::vec3(65408, 128, 0)})
        EXPECT_EQ(there_and_back(exact, TexelFormat::shared_exponent), exact);
    EXPECT_EQ(there_and_back(glm::vec3(-1, 1e9f, 0), TexelFormat::shared_exponent), glm::vec3(0, 65408, 0));
    EXPECT_EQ(there_and_back(glm::vec3(0.9999f), TexelFormat::shared_exponent), glm::vec3(1)); // carries over
}

TEST(TexelFormat, NamesAreReadAsTheyAreWritten) {
    for (const TexelFormat format : {TexelFormat::half_rgb, TexelFormat::float_rgb, TexelFormat::shared_exponent})
        EXPECT_EQ(texel_format_from_name(texel_format_name(format)), format);
    EXPECT_THROW(texel_format_from_name("byte"), InputError);
}

} // namespace
} // namespace kokage
