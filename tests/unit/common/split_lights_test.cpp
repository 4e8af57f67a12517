#include "common/environment/light_regions.h"
#include "common/environment/split_lights.h"
#include "common/services/error.h"
#include "common/services/random.h"

#include <cmath>
#include <gtest/gtest.h>
#include <set>

using namespace kokage;

namespace {

Image filled(int width, int height, glm::vec3 color) {
    Image image(width, height, 3);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        image.pixels[i] = color[glm::length_t(i % 3)];
    return image;
}

void set_pixel(Image& image, int x, int y, glm::vec3 color) {
    for (int c = 0; c < 3; ++c)
        image.at(x, y)[c] = color[glm::length_t(c)];
}

glm::dvec3 light_sum(const LightSplit& split) {
    glm::dvec3 sum(0);
    for (const DistantLight& light : split.lights)
        sum += glm::dvec3(light.irradiance);
    return sum;
}

/// What must hold of every split.
void expect_sound(const Image& image, const LightSplit& split, int max_lights = 64) {
    EXPECT_LE(split.lights.size(), std::size_t(max_lights));
    const glm::dvec3 before = radiance_integral(image), after = radiance_integral(split.remainder) + light_sum(split);
    for (glm::length_t c = 0; c < 3; ++c)
        EXPECT_LE(std::abs(after[c] - before[c]), 1e-5 * before[c]) << "channel " << c;
    ASSERT_EQ(split.remainder.pixels.size(), std::size_t(image.width) * std::size_t(image.height) * 3);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (int c = 0; c < 3; ++c) {
                ASSERT_GE(split.remainder.at(x, y)[c], 0);
                ASSERT_LE(split.remainder.at(x, y)[c], image.at(x, y)[c]);
            }
    Image whole = split.remainder;
    for (const DistantLight& light : split.lights)
        for (const DistantLight::Pixel& pixel : light.pixels)
            for (int c = 0; c < 3; ++c)
                whole.at(pixel.x, pixel.y)[c] += pixel.radiance[c];
    for (std::size_t i = 0; i < whole.pixels.size(); ++i)
        ASSERT_NEAR(whole.pixels[i], image.pixels[i], 1e-6f * image.pixels[i]);
    for (const DistantLight& light : split.lights) {
        EXPECT_NEAR(glm::length(light.direction), 1, 1e-5);
        EXPECT_FALSE(light.texels.empty());
        EXPECT_LE(light.texels.size(), std::size_t(LightSplitting().max_texels));
        glm::dvec3 sum(0);
        for (const DistantLight::Texel& texel : light.texels) {
            sum += glm::dvec3(texel.irradiance);
            EXPECT_TRUE(std::isfinite(luminance(texel.irradiance)));
            EXPECT_GE(std::min({texel.irradiance.r, texel.irradiance.g, texel.irradiance.b}), 0.f);
            EXPECT_GT(texel.half_angle, 0);
            EXPECT_LE(std::acos(std::min(1.f, glm::dot(texel.direction, light.direction))) + texel.half_angle,
                      light.half_angle + 1e-3f);
        }
        for (glm::length_t c = 0; c < 3; ++c)
            EXPECT_NEAR(sum[c], double(light.irradiance[c]), 1e-5 * double(light.irradiance[c]));
    }
}

TEST(SplitLights, OnePixelSunBecomesOneLight) {
    Image image = filled(256, 128, glm::vec3(0.5f, 0.6f, 0.7f));
    set_pixel(image, 100, 30, {1000, 900, 800});
    const LightSplit split = split_lights(image);
    expect_sound(image, split);
    ASSERT_EQ(split.lights.size(), 1u);
    const DistantLight& sun = split.lights[0];
    EXPECT_LT(glm::distance(sun.direction, glm::vec3(pixel_direction(100, 30, 256, 128))), 1e-6f);
    const double solid_angle = pixel_solid_angle(30, 256, 128);
    EXPECT_NEAR(sun.irradiance.r, 999.5 * solid_angle, 1e-4);
    // Its place is filled from around it.
    EXPECT_FLOAT_EQ(split.remainder.at(100, 30)[2], 0.7f);
    EXPECT_NEAR(2 * kPiDouble * (1 - std::cos(double(sun.half_angle))), solid_angle, 1e-3 * solid_angle);
}

TEST(SplitLights, RegionsJoinAcrossTheSeamAndOverThePoles) {
    Image image = filled(128, 64, glm::vec3(0.1f));
    for (int x : {126, 127, 0, 1})
        set_pixel(image, x, 20, glm::vec3(500));
    LightSplit split = split_lights(image);
    expect_sound(image, split);
    ASSERT_EQ(split.lights.size(), 1u);
    EXPECT_LT(glm::distance(split.lights[0].direction, direction_from_lat_long({0.f, 20.5f / 64})), 2e-3f);

    image = filled(128, 64, glm::vec3(0.1f));
    for (int x = 0; x < 128; x += 32)
        set_pixel(image, x, 0, glm::vec3(5e4f)); // four pixels that meet at the pole
    set_pixel(image, 1, 1, glm::vec3(5e4f));
    split = split_lights(image);
    expect_sound(image, split);
    ASSERT_EQ(split.lights.size(), 1u);
    EXPECT_GT(split.lights[0].direction.y, 0.999f);

    image = filled(128, 64, glm::vec3(0.1f));
    set_pixel(image, 3, 63, glm::vec3(5e4f));
    set_pixel(image, 67, 63, glm::vec3(5e4f));
    EXPECT_EQ(split_lights(image).lights.size(), 1u);
}

TEST(SplitLights, TwoLampsApartStayTwo) {
    Image image = filled(360, 180, glm::vec3(0.1f));
    set_pixel(image, 100, 90, glm::vec3(1000));
    set_pixel(image, 103, 90, glm::vec3(2000)); // 3 degrees
    LightSplit split = split_lights(image);
    expect_sound(image, split);
    ASSERT_EQ(split.lights.size(), 2u);
    EXPECT_GT(split.lights[0].irradiance.r, split.lights[1].irradiance.r);
    split = split_lights(image, {.gap_degrees = 3.1});
    EXPECT_EQ(split.lights.size(), 1u);
}

TEST(SplitLights, KeepsTheBrightest64OfAHundredLamps) {
    Image image = filled(512, 256, glm::vec3(0.01f));
    for (int i = 0; i < 100; ++i)
        set_pixel(image, 10 + 50 * (i % 10), 30 + 20 * (i / 10), glm::vec3(500.f + float(i)));
    const LightSplit split = split_lights(image);
    expect_sound(image, split);
    EXPECT_EQ(split.regions_found, 100u);
    EXPECT_EQ(split.lights.size(), 64u);
    for (std::size_t i = 1; i < split.lights.size(); ++i)
        EXPECT_GE(split.lights[i - 1].irradiance.r, split.lights[i].irradiance.r);
    EXPECT_EQ(split_lights(image, {.max_lights = 0}).remainder.pixels, image.pixels);
}

TEST(SplitLights, StarsStay) {
    Image image = filled(512, 256, glm::vec3(0.1f));
    set_pixel(image, 50, 100, glm::vec3(10)); // a hundred times its surroundings, but 0.0012 of all light
    const LightSplit split = split_lights(image);
    EXPECT_TRUE(split.lights.empty());
    EXPECT_EQ(split.remainder.pixels, image.pixels);
}

TEST(SplitLights, SkyBetweenTreesGivesItsBrightestParts) {
    // A bright upper half with holes is no light as a whole; the sun in it is.
    Image image = filled(256, 128, glm::vec3(0.001f));
    Random random(3);
    for (int y = 20; y < 50; ++y)
        for (int x = 0; x < 256; ++x)
            if (random.uniform() < 0.03f)
                set_pixel(image, x, y, glm::vec3(5));
    set_pixel(image, 128, 40, glm::vec3(5000));
    const LightSplit split = split_lights(image);
    expect_sound(image, split);
    ASSERT_GE(split.lights.size(), 1u);
    EXPECT_LT(glm::distance(split.lights[0].direction, glm::vec3(pixel_direction(128, 40, 256, 128))), 0.01f);
    for (const DistantLight& light : split.lights)
        EXPECT_LE(light.half_angle, 32 * kPi / 180);
}

TEST(SplitLights, WideEvenRegionOverBlackStays) {
    // Threshold 0, and too wide for a light at every threshold.
    Image image(128, 64, 3);
    for (int y = 20; y < 24; ++y)
        for (int x = 0; x < 128; ++x)
            set_pixel(image, x, y, glm::vec3(3));
    LightSplit split = split_lights(image);
    EXPECT_TRUE(split.lights.empty());
    EXPECT_EQ(split.remainder.pixels, image.pixels);
    set_pixel(image, 50, 22, glm::vec3(3e3f)); // a lamp within it is one
    split = split_lights(image);
    expect_sound(image, split);
    EXPECT_EQ(split.lights.size(), 1u);
}

TEST(SplitLights, ConstantAndBlackHaveNoLights) {
    for (const float value : {0.f, 1e-30f, 0.5f, 1e30f})
        for (const auto& [width, height] : {std::pair(1, 1), {2, 1}, {64, 32}}) {
            const Image image = filled(width, height, glm::vec3(value));
            const LightSplit split = split_lights(image);
            EXPECT_TRUE(split.lights.empty()) << value;
            EXPECT_EQ(split.remainder.pixels, image.pixels);
        }
    EXPECT_THROW(split_lights(Image()), InputError);
    EXPECT_THROW(split_lights(Image(4, 2, 1)), InputError);
}

TEST(SplitLights, ExtremeRadianceStaysFiniteAndKept) {
    for (const float scale : {1e-30f, 1e-10f, 1.f, 1e25f}) {
        Image image = filled(64, 32, glm::vec3(0.1f * scale));
        for (int x = 3; x < 6; ++x)
            set_pixel(image, x, 8, glm::vec3(1e5f, 2e5f, 0.f) * scale);
        const LightSplit split = split_lights(image);
        expect_sound(image, split);
        EXPECT_EQ(split.lights.size(), 1u) << scale;
    }
    Image image(64, 32, 3); // one pixel in the dark
    set_pixel(image, 9, 9, glm::vec3(1e30f));
    const LightSplit split = split_lights(image);
    expect_sound(image, split);
    ASSERT_EQ(split.lights.size(), 1u);
    EXPECT_EQ(split.remainder.at(9, 9)[0], 0.f);
}

TEST(SplitLights, MergesTexelsWithoutMovingTheLight) {
    // A soft disc of some thousand pixels.
    Image image = filled(720, 360, glm::vec3(0.01f));
    const glm::dvec3 centre = glm::normalize(glm::dvec3(1, 0.4, 0.2));
    for (int y = 0; y < 360; ++y)
        for (int x = 0; x < 720; ++x)
            if (const double apart = std::acos(glm::dot(centre, pixel_direction(x, y, 720, 360))); apart < 0.2)
                set_pixel(image, x, y, glm::vec3(float(100 * (1 - apart * apart / 0.05))));
    const LightSplit split = split_lights(image);
    expect_sound(image, split);
    ASSERT_EQ(split.lights.size(), 1u);
    const DistantLight& light = split.lights[0];
    EXPECT_EQ(light.texels.size(), 64u);
    EXPECT_NEAR(std::acos(glm::dot(glm::dvec3(light.direction), centre)), 0, 2e-3);
    EXPECT_NEAR(light.half_angle, 0.2, 0.04);
    // Irradiance of a slanted surface, from all pixels and from the merged ones.
    const glm::dvec3 normal = glm::normalize(glm::dvec3(0.2, 1, -0.3));
    double exact = 0, merged = 0;
    for (int y = 0; y < 360; ++y)
        for (int x = 0; x < 720; ++x)
            exact += double(image.at(x, y)[0] - split.remainder.at(x, y)[0]) * pixel_solid_angle(y, 720, 360) *
                     std::max(0.0, glm::dot(normal, pixel_direction(x, y, 720, 360)));
    for (const DistantLight::Texel& texel : light.texels)
        merged += double(texel.irradiance.r) * std::max(0.0, glm::dot(normal, glm::dvec3(texel.direction)));
    EXPECT_NEAR(merged / exact, 1, 2e-3);
}

/// The slow twin: every pair of bright pixels is compared; components by flooding.
std::set<std::set<std::pair<int, int>>> slow_regions(const Image& image, double threshold, double gap_degrees) {
    std::vector<std::pair<int, int>> bright;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            if ((image.at(x, y)[0] + image.at(x, y)[1] + image.at(x, y)[2]) / 3 > threshold)
                bright.emplace_back(x, y);
    auto joined = [&](std::pair<int, int> a, std::pair<int, int> b) {
        const int dx = std::abs(a.first - b.first), dy = std::abs(a.second - b.second);
        if (dy <= 1 && (dx <= 1 || dx == image.width - 1))
            return true;
        if (a.second == b.second && (a.second == 0 || a.second == image.height - 1))
            return true;
        const glm::dvec3 da = pixel_direction(a.first, a.second, image.width, image.height);
        const glm::dvec3 db = pixel_direction(b.first, b.second, image.width, image.height);
        return std::acos(std::clamp(glm::dot(da, db), -1.0, 1.0)) <= gap_degrees * kPiDouble / 180;
    };
    std::vector<bool> seen(bright.size());
    std::set<std::set<std::pair<int, int>>> regions;
    for (std::size_t i = 0; i < bright.size(); ++i) {
        if (seen[i])
            continue;
        std::vector<std::size_t> stack{i};
        std::set<std::pair<int, int>> region;
        seen[i] = true;
        while (!stack.empty()) {
            const std::size_t a = stack.back();
            stack.pop_back();
            region.insert(bright[a]);
            for (std::size_t b = 0; b < bright.size(); ++b)
                if (!seen[b] && joined(bright[a], bright[b])) {
                    seen[b] = true;
                    stack.push_back(b);
                }
        }
        regions.insert(region);
    }
    return regions;
}

TEST(LightRegions, AreThoseOfComparingAllPairs) {
    Random random(7);
    for (const auto& [width, height] : {std::pair(40, 20), {33, 17}, {20, 40}, {64, 8}})
        for (const double gap : {0.0, 9.1, 14.3, 31.7})
            for (const float density : {0.01f, 0.04f, 0.1f}) {
                Image image = filled(width, height, glm::vec3(0.01f));
                for (int y = 0; y < height; ++y)
                    for (int x = 0; x < width; ++x)
                        if (random.uniform() < density)
                            set_pixel(image, x, y, glm::vec3(1, 2, 3));
                BrightPixels bright = find_bright_pixels(image, 1.5);
                std::set<std::set<std::pair<int, int>>> fast;
                for (const LightRegion& region : connect_regions(image, bright.runs, 0, gap)) {
                    std::set<std::pair<int, int>> pixels;
                    for (const PixelRun& run : region.runs)
                        for (int x = run.begin; x < run.end; ++x)
                            pixels.emplace(x, run.y);
                    fast.insert(pixels);
                }
                EXPECT_EQ(fast, slow_regions(image, bright.threshold, gap))
                    << width << " x " << height << " gap " << gap;
            }
}

TEST(LightRegions, BackgroundIsWhatIsNotBright) {
    Image image = filled(100, 50, glm::vec3(0.2f, 0.3f, 0.4f));
    set_pixel(image, 20, 20, glm::vec3(1e6f)); // raises the first mean over the second lamp
    set_pixel(image, 60, 20, glm::vec3(30.f));
    const BrightPixels bright = find_bright_pixels(image, 8);
    EXPECT_EQ(bright.runs.size(), 2u);
    EXPECT_NEAR(bright.background, 0.3, 1e-6);
    EXPECT_NEAR(bright.threshold, 2.4, 0.01);
}

} // namespace
