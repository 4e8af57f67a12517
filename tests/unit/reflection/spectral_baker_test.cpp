#include "common/directions/ring_transform.h"
#include "common/environment/lat_long.h"
#include "common/environment/split_lights.h"
#include "common/services/error.h"
#include "common/services/parallel.h"
#include "common/services/random.h"
#include "reflection/maps/brute_force_baker.h"
#include "reflection/maps/lobe_lights.h"
#include "reflection/maps/shell_map.h"
#include "reflection/maps/spectral_baker.h"
#include "reflection/maps/spectral_plan.h"
#include "reflection/maps/spectral_read.h"
#include "tests/support/temporary_folder.h"

#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <string>

using namespace kokage;

namespace {

glm::vec3 some_direction(Random& random) {
    const double height = 2 * random.uniform_double() - 1, azimuth = 2 * kPiDouble * random.uniform_double(),
                 sine = std::sqrt(1 - height * height);
    return glm::vec3(sine * std::cos(azimuth), height, sine * std::sin(azimuth));
}

/// Texels in all directions, the poles among them, with parameters spread evenly by their logarithm.
TexelLayout scattered(LobeKind kind, double least, double most, std::size_t count, std::uint64_t seed = 1) {
    TexelLayout layout;
    layout.kind = kind;
    Random random(seed);
    const glm::vec3 poles[] = {{0, 1, 0}, {0, -1, 0}, {-1, 0, 0}, {-1, 0, -1e-8f}, {1e-5f, 1, 0}};
    for (std::size_t i = 0; i < count; ++i) {
        layout.directions.push_back(i < std::size(poles) ? poles[i] : some_direction(random));
        layout.parameters.push_back(float(least * std::pow(most / least, random.uniform_double())));
    }
    return layout;
}

/// Hue once round across, saturation downwards, lightness 1/2.
Image colour_pattern(int width, int height) {
    Image image(width, height, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c) {
                const double k = std::fmod(8.0 - 4 * c + 4 + (x + 0.5) / width * 12, 12),
                             half = 0.5 * (y + 0.5) / height;
                image.at(x, y)[c] = float(0.5 - half * std::max(-1.0, std::min({k - 3, 9 - k, 1.0})));
            }
    return image;
}

Image noise_to_bake(int width, int height, std::uint64_t seed) {
    Image image(width, height, 3);
    Random random(seed);
    for (float& value : image.pixels)
        value = random.uniform();
    return image;
}

struct Baked {
    std::vector<glm::vec3> filtered;
    WorkReport report;
    bool said(std::string_view skip) const {
        for (const WorkReport::Skip& s : report.skips)
            if (s.what.find(skip) != std::string::npos)
                return true;
        return false;
    }
};

Baked bake(const TexelLayout& layout, const Environment& environment, const SpectralSettings& settings = {}) {
    Baked baked;
    baked.filtered.assign(layout.size(), glm::vec3(std::numeric_limits<float>::quiet_NaN()));
    spectral_baker(layout, environment.remainder.width, environment.remainder.height, settings, baked.report)
        ->bake(environment, baked.filtered, baked.report);
    return baked;
}

std::vector<glm::vec3> truth(const TexelLayout& layout, const Environment& environment) {
    std::vector<glm::vec3> filtered(layout.size());
    WorkReport report;
    brute_force_baker(layout, environment.remainder.width, environment.remainder.height)
        ->bake(environment, filtered, report);
    return filtered;
}

struct Errors {
    double largest = 0, largest_relative = 0, least = 0;
};

/// Relative errors by a denominator of at least `floor`.
Errors errors(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b, double floor = 1) {
    Errors errors;
    for (std::size_t i = 0; i < a.size(); ++i)
        for (glm::length_t c = 0; c < 3; ++c) {
            const double error = std::abs(double(a[i][c]) - double(b[i][c]));
            // So that a NaN is the largest error.
            if (!(error <= errors.largest))
                errors.largest = error;
            if (const double relative = error / std::max(double(b[i][c]), floor);
                !(relative <= errors.largest_relative))
                errors.largest_relative = relative;
            errors.least = std::min(errors.least, double(a[i][c]));
        }
    return errors;
}

Environment surroundings(Image image) {
    Environment environment;
    environment.remainder = std::move(image);
    return environment;
}

TEST(SpectralBaker, IsTheBruteForceWithinItsTolerance) {
    for (const LobeKind kind : {LobeKind::phong, LobeKind::ggx}) {
        const bool phong = kind == LobeKind::phong;
        const TexelLayout layout = phong ? scattered(kind, 0.3, 2000, 1200) : scattered(kind, 0.2, 1, 1200);
        for (const bool pattern : {true, false}) {
            const Environment environment =
                surroundings(pattern ? colour_pattern(256, 128) : noise_to_bake(256, 128, 3));
            const Errors found = errors(bake(layout, environment).filtered, truth(layout, environment));
            EXPECT_LT(found.largest, pattern ? 1.5e-4 : 2e-4)
                << lobe_kind_name(kind) << (pattern ? " pattern" : " noise");
        }
    }
}

TEST(SpectralBaker, AFewLobesAreExactShells) {
    TexelLayout layout = scattered(LobeKind::ggx, 0.25, 1, 800);
    for (std::size_t i = 0; i < layout.size(); ++i)
        layout.parameters[i] = 0.25f * float(1 + i * 4 / layout.size());
    const SpectralPlan plan(layout, 256, 128, 1e-4);
    EXPECT_EQ(plan.shells().size(), 4u);
    EXPECT_EQ(plan.shells_a_texel(), 1u);
    const Environment environment = surroundings(colour_pattern(256, 128));
    EXPECT_LT(errors(bake(layout, environment).filtered, truth(layout, environment)).largest, 1e-4);
}

TEST(SpectralBaker, SmallerToleranceSmallerError) {
    const TexelLayout layout = scattered(LobeKind::phong, 5, 1000, 600);
    const Environment environment = surroundings(noise_to_bake(128, 64, 5));
    const std::vector<glm::vec3> right = truth(layout, environment);
    double before = 1;
    for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
        const double error = errors(bake(layout, environment, {tolerance, {}}).filtered, right).largest;
        EXPECT_LT(error, 2 * tolerance);
        EXPECT_LT(error, before);
        before = error;
    }
}

TEST(SpectralBaker, ASunIsALobeAndNothingIsNegative) {
    Image image = noise_to_bake(256, 128, 7);
    for (int c = 0; c < 3; ++c)
        image.at(70, 40)[c] = 1e6f;
    const Environment environment = surroundings(std::move(image));
    const double mean = luminance_integral(environment.remainder) / (4 * kPiDouble);
    const TexelLayout layout = scattered(LobeKind::phong, 1, 2000, 3000);
    const Baked baked = bake(layout, environment);
    const Errors found = errors(baked.filtered, truth(layout, environment), 1e-3 * mean);
    EXPECT_LT(found.largest_relative, 3e-3);
    EXPECT_GE(found.least, 0);
}

TEST(SpectralBaker, LightsOfTheUserAreFilteredToo) {
    Environment environment = surroundings(colour_pattern(128, 64));
    environment.distant_lights.push_back(
        {"sun", glm::normalize(glm::vec3(1, 2, 3)), 0.00465f, glm::vec3(3, 2, 1), {}, {}});
    environment.distant_lights.push_back({"lamp", glm::normalize(glm::vec3(-1, 1, 0)), 0.3f, glm::vec3(1), {}, {}});
    environment.distant_lights.push_back({"star", glm::vec3(0, -1, 0), 0, glm::vec3(0.2f), {}, {}});
    for (const LobeKind kind : {LobeKind::phong, LobeKind::ggx}) {
        const TexelLayout layout =
            kind == LobeKind::phong ? scattered(kind, 1, 500, 500) : scattered(kind, 0.3, 1, 500);
        const std::vector<glm::vec3> right = truth(layout, environment);
        EXPECT_LT(errors(bake(layout, environment).filtered, right, 1).largest_relative, 1e-3) << lobe_kind_name(kind);
    }
}

TEST(SpectralBaker, PhongLobesTooNarrowForTheImageAreSummedPixelByPixel) {
    const Environment environment = surroundings(noise_to_bake(64, 32, 9));
    const TexelLayout layout = scattered(LobeKind::phong, 10, 1e5, 800);
    const SpectralPlan plan(layout, 64, 32, 1e-4);
    EXPECT_TRUE(plan.is_near_only(2e4f));
    EXPECT_FALSE(plan.is_near_only(20));
    EXPECT_LT(errors(bake(layout, environment).filtered, truth(layout, environment)).largest, 2e-4);
}

TEST(SpectralBaker, NarrowGgxIsAPartInHarmonicsAndPixelsNearby) {
    const TexelLayout layout = scattered(LobeKind::ggx, 0.01, 1, 1500);
    const SpectralPlan plan(layout, 256, 128, 1.5e-4);
    EXPECT_FALSE(plan.is_near_only(0.01f));
    EXPECT_GT(plan.near_part(0.01f).reach, 0);
    EXPECT_LT(plan.near_part(0.01f).reach, 0.01);
    EXPECT_GT(plan.near_part(0.01f).reach, plan.near_part(0.15f).reach);
    EXPECT_EQ(plan.near_part(0.4f).reach, 0);
    EXPECT_LE(plan.bands(), 512);
    for (const bool pattern : {true, false}) {
        const Environment environment = surroundings(pattern ? colour_pattern(256, 128) : noise_to_bake(256, 128, 3));
        const Errors found = errors(bake(layout, environment).filtered, truth(layout, environment));
        EXPECT_LT(found.largest, 1.5e-4) << (pattern ? "pattern" : "noise");
    }
}

TEST(SpectralBaker, AFewNarrowGgxLobes) {
    for (const float roughness : {0.001f, 0.02f, 0.05f, 0.1f, 0.13f}) {
        TexelLayout layout = scattered(LobeKind::ggx, 0.5, 0.5, 1000);
        std::fill(layout.parameters.begin(), layout.parameters.end(), roughness);
        const Environment environment = surroundings(noise_to_bake(256, 128, 11));
        EXPECT_LT(errors(bake(layout, environment).filtered, truth(layout, environment)).largest, 1.5e-4) << roughness;
    }
}

TEST(SpectralBaker, NarrowGgxInTheTolerancesThatAreAsked) {
    const TexelLayout layout = scattered(LobeKind::ggx, 0.02, 0.3, 800);
    const Environment environment = surroundings(noise_to_bake(128, 64, 5));
    const std::vector<glm::vec3> right = truth(layout, environment);
    for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-5})
        EXPECT_LT(errors(bake(layout, environment, {tolerance, {}}).filtered, right).largest, 1.5 * tolerance);
}

/// Bright and dark side by side over six orders of magnitude, a sun, and texels at, beside and between its pixels.
TEST(SpectralBaker, NarrowGgxInHighContrast) {
    Image image = noise_to_bake(256, 128, 7);
    for (float& value : image.pixels)
        value = std::pow(value, 12.f);
    image.at(70, 40)[0] = image.at(70, 40)[1] = image.at(70, 40)[2] = 1e6f;
    const Environment environment = surroundings(std::move(image));
    const double mean = luminance_integral(environment.remainder) / (4 * kPiDouble);
    TexelLayout layout = scattered(LobeKind::ggx, 0.005, 0.5, 2000);
    const glm::dvec3 sun = pixel_direction(70, 40, 256, 128), beside = pixel_direction(71, 41, 256, 128);
    for (const double share : {0.0, 0.1, 0.5, 0.9, 1.0, 2.0})
        for (const float roughness : {0.005f, 0.05f, 0.1f, 0.2f}) {
            layout.directions.emplace_back(glm::normalize(glm::mix(sun, beside, share)));
            layout.parameters.push_back(roughness);
        }
    const Baked baked = bake(layout, environment);
    const Errors found = errors(baked.filtered, truth(layout, environment), 1e-3 * mean);
    EXPECT_LT(found.largest_relative, 3e-3);
    EXPECT_GE(found.least, 0);
}

TEST(SpectralBaker, SumsPixelByPixelShowProgressAndCanBeStopped) {
    struct StopsWithin : Progress {
        std::atomic<std::size_t> left{100};
        void advance(std::size_t steps) override { left -= std::min(left.load(), steps); }
        bool stop_requested() const override { return left == 0; }
    } progress;
    const TexelLayout layout = scattered(LobeKind::phong, 2e4, 5e4, 1000);
    Environment environment;
    environment.remainder = noise_to_bake(64, 32, 3);
    std::vector<glm::vec3> filtered(layout.size());
    WorkReport report;
    const std::unique_ptr<Baker> baker = spectral_baker(layout, 64, 32, {}, report);
    EXPECT_THROW(baker->bake(environment, filtered, report, progress), Stopped);
}

TEST(SpectralBaker, ImagesOfAnyShape) {
    for (const TexelLayout& layout :
         {scattered(LobeKind::phong, 0.3, 3000, 300), scattered(LobeKind::ggx, 0.01, 1, 300)})
        for (const glm::ivec2 size : {glm::ivec2(1, 1), {2, 1}, {1, 2}, {3, 5}, {97, 31}, {40, 40}, {20, 90}}) {
            const Environment environment = surroundings(noise_to_bake(size.x, size.y, 4));
            TexelLayout texels = layout;
            if (size.x * size.y == 2) { // the first ones are as far from both pixels: either is right
                texels.directions.erase(texels.directions.begin(), texels.directions.begin() + 5);
                texels.parameters.erase(texels.parameters.begin(), texels.parameters.begin() + 5);
            }
            EXPECT_LT(errors(bake(texels, environment).filtered, truth(texels, environment)).largest, 4e-4)
                << size.x << "x" << size.y << " " << lobe_kind_name(layout.kind);
        }
}

TEST(SpectralBaker, OneColourNeedsOneBandAndSaysSo) {
    const TexelLayout layout = scattered(LobeKind::phong, 1, 1000, 100);
    Image image(64, 32, 3);
    for (const float value : {0.f, 0.7f, 1e30f}) {
        std::fill(image.pixels.begin(), image.pixels.end(), value);
        const Baked baked = bake(layout, surroundings(image));
        EXPECT_TRUE(baked.said("first band"));
        for (const glm::vec3& texel : baked.filtered)
            EXPECT_EQ(texel, glm::vec3(value));
    }
}

TEST(SpectralBaker, EnormousAndTinyPixelsStayFinite) {
    const TexelLayout layout = scattered(LobeKind::phong, 1, 3000, 300);
    for (const float scale : {1e-30f, 1e30f}) {
        Image image = noise_to_bake(128, 64, 2);
        for (float& value : image.pixels)
            value *= scale;
        const Environment environment = surroundings(std::move(image));
        EXPECT_LT(
            errors(bake(layout, environment).filtered, truth(layout, environment), double(scale)).largest_relative,
            3e-4);
    }
    Image image = noise_to_bake(128, 64, 2);
    image.at(5, 5)[0] = 1e30f;
    const Environment environment = surroundings(std::move(image));
    const double mean = luminance_integral(environment.remainder) / (4 * kPiDouble);
    EXPECT_LT(errors(bake(layout, environment).filtered, truth(layout, environment), 1e-3 * mean).largest_relative,
              3e-3);
}

TEST(SpectralBaker, RefusesWhatItWasNotMadeFor) {
    const TexelLayout layout = scattered(LobeKind::phong, 1, 100, 10);
    WorkReport report;
    const auto baker = spectral_baker(layout, 32, 16, {}, report);
    std::vector<glm::vec3> filtered(layout.size());
    EXPECT_THROW(baker->bake(surroundings(noise_to_bake(16, 8, 1)), filtered, report), InputError);
    filtered.pop_back();
    EXPECT_THROW(baker->bake(surroundings(noise_to_bake(32, 16, 1)), filtered, report), InputError);
    filtered.resize(layout.size());
    for (const float bad : {-1.f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        Image image = noise_to_bake(32, 16, 1);
        image.at(3, 4)[1] = bad;
        EXPECT_THROW(baker->bake(surroundings(std::move(image)), filtered, report), InputError);
    }
}

TEST(SpectralBaker, SameBitsWithAnyNumberOfThreadsAndFrameAfterFrame) {
    for (const TexelLayout& layout :
         {scattered(LobeKind::phong, 1, 1000, 9000), scattered(LobeKind::ggx, 0.02, 1, 9000)}) {
        Image image = noise_to_bake(128, 64, 2);
        image.at(5, 5)[0] = 1e4f;
        const Environment environment = surroundings(std::move(image)), other = surroundings(noise_to_bake(128, 64, 8));
        set_thread_count(1);
        const std::vector<glm::vec3> one = bake(layout, environment).filtered;
        set_thread_count(0);
        WorkReport report;
        const auto baker = spectral_baker(layout, 128, 64, {}, report);
        std::vector<glm::vec3> filtered(layout.size());
        baker->bake(other, filtered, report);
        baker->bake(environment, filtered, report);
        EXPECT_EQ(filtered, one);
    }
}

std::string refusal(const TexelLayout& layout, int width, int height, const SpectralSettings& settings) {
    WorkReport report;
    try {
        spectral_baker(layout, width, height, settings, report);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(SpectralBaker, AStoredSetupGivesTheSameBits) {
    const Environment environment = surroundings(noise_to_bake(64, 32, 2));
    for (const TexelLayout& layout :
         {scattered(LobeKind::phong, 1, 300, 500), scattered(LobeKind::ggx, 0.02, 1, 500)}) {
        const TemporaryFolder folder;
        const SpectralSettings settings{1e-3, folder / "set-up"};
        const std::vector<glm::vec3> made = bake(layout, environment, settings).filtered;
        ASSERT_TRUE(std::filesystem::exists(settings.stored_setup));
        const Baked again = bake(layout, environment, settings);
        EXPECT_EQ(again.filtered, made);
        EXPECT_EQ(again.report.stages.front().name, "reading the set-up");
        EXPECT_EQ(bake(layout, environment, {1e-3, {}}).filtered, made);
    }
}

TEST(SpectralBaker, RefusesADamagedOrForeignSetupByName) {
    const TemporaryFolder folder;
    const SpectralSettings settings{1e-3, folder / "set-up"};
    const TexelLayout layout = scattered(LobeKind::phong, 1, 100, 20);
    ASSERT_EQ(refusal(layout, 32, 16, settings), "");
    ASSERT_EQ(refusal(layout, 32, 16, settings), "");
    auto expect_refused = [&](const TexelLayout& wanted, int width, const SpectralSettings& with, const char* why) {
        const std::string told = refusal(wanted, width, 16, with);
        EXPECT_NE(told.find(why), std::string::npos) << told;
        EXPECT_NE(told.find(settings.stored_setup.string()), std::string::npos) << told;
    };
    expect_refused(layout, 64, settings, "another size");
    expect_refused(layout, 32, {1e-2, settings.stored_setup}, "tolerance");
    TexelLayout other = layout;
    other.parameters[3] *= 1.001f;
    expect_refused(other, 32, settings, "another size, lobe");

    const std::string whole = read_text(settings.stored_setup);
    auto write = [&](const std::string& bytes) {
        std::ofstream(settings.stored_setup, std::ios::binary | std::ios::trunc) << bytes;
    };
    write(whole.substr(0, whole.size() - 4));
    expect_refused(layout, 32, settings, "truncated");
    write(whole.substr(0, 20));
    expect_refused(layout, 32, settings, "no stored set-up");
    write(whole + "1234");
    expect_refused(layout, 32, settings, "altered");
    for (const std::size_t place :
         {std::size_t(8), std::size_t(17), std::size_t(30), whole.size() / 2, whole.size() - 1}) {
        std::string altered = whole;
        altered[place] = char(altered[place] ^ 1);
        write(altered);
        expect_refused(layout, 32, settings, place == 8 ? "version" : "altered");
    }
    write("");
    expect_refused(layout, 32, settings, "no stored set-up");
    write(whole);
    EXPECT_EQ(refusal(layout, 32, 16, settings), "");
}

TEST(LobeLights, AreTheLobesOneByOne) {
    Random random(4);
    for (const LobeKind kind : {LobeKind::phong, LobeKind::ggx}) {
        const TexelLayout layout =
            kind == LobeKind::phong ? scattered(kind, 0.3, 5000, 3000) : scattered(kind, 0.05, 1, 3000);
        std::vector<ClusterOfLight> clusters(7);
        for (ClusterOfLight& cluster : clusters) {
            DistantLight light;
            light.direction = some_direction(random);
            for (int i = 0; i < 20; ++i)
                light.texels.push_back({glm::normalize(light.direction + 0.05f * some_direction(random)),
                                        glm::vec3(random.uniform(), random.uniform(), random.uniform()), 0});
            cluster = cluster_of(light, 1e-4);
        }
        std::vector<float> factors;
        for (std::size_t i = 0; i < layout.size(); ++i)
            factors.push_back(0.5f + random.uniform());
        std::vector<glm::vec3> slow(layout.size(), glm::vec3(1)), fast = slow;
        for (std::size_t i = 0; i < layout.size(); ++i)
            for (const ClusterOfLight& cluster : clusters)
                for (const PointOfLight& point : cluster.points) {
                    const glm::dvec3 between = glm::dvec3(point.direction) - glm::dvec3(layout.directions[i]);
                    slow[i] += factors[i] * point.irradiance *
                               float(lobe_value({kind, double(layout.parameters[i])}, glm::dot(between, between)));
                }
        const std::uint64_t lobes = LobeLights(layout).add(clusters, 1e-5f, factors, fast);
        EXPECT_LT(errors(fast, slow).largest_relative, 1e-4) << lobe_kind_name(kind);
        EXPECT_GT(lobes, 1000u);
        // Narrow lobes are out of most lights' reach.
        EXPECT_LT(lobes, layout.size() * 7 * 20 * (kind == LobeKind::phong ? 7 : 10) / 10);
    }
}

TEST(ReadTexels, IsTheSplineThere) {
    const int bands = 12;
    RingCoefficients coefficients(bands);
    RingAnalysis(24, 12, bands).transform(noise_to_bake(24, 12, 1), 1, coefficients);
    std::vector<RingGrid> grids;
    for (const int rings : {12, 20, 24, 30}) {
        grids.emplace_back(rings, 2 * rings);
        RingSynthesis(bands, rings, 2 * rings)
            .transform(coefficients, std::vector<std::vector<double>>{std::vector<double>(std::size_t(bands), 1.0)}, 1,
                       std::span(&grids.back(), 1));
    }
    const TexelLayout layout = scattered(LobeKind::phong, 1, 2, 500);
    Random random(3);
    for (const std::size_t grids_a_texel : {1u, 4u}) {
        std::vector<TexelPlace> places;
        std::vector<glm::vec3> slow, fast(layout.size());
        for (std::size_t i = 0; i < layout.size(); ++i) {
            ShellMix mix;
            mix.first = grids_a_texel == 1 ? random.below(4) : 0;
            glm::vec3 sum(0);
            for (std::size_t k = 0; k < grids_a_texel; ++k) {
                mix.weights[k] = random.uniform();
                sum += mix.weights[k] * grids[mix.first + k].lookup(glm::normalize(glm::dvec3(layout.directions[i])));
            }
            places.push_back(texel_place(layout.directions[i], mix, std::uint32_t(i)));
            slow.push_back(glm::max(2.f * sum, glm::vec3(0)));
        }
        read_texels(places, grids, grids_a_texel, 2, fast);
        EXPECT_LT(errors(fast, slow).largest, 3e-5);
    }
}

} // namespace
