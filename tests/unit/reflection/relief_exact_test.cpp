// The exact tracer against the truth, cell by cell in double precision.
#include "common/services/error.h"
#include "reflection/relief/cell_by_cell.h"
#include "reflection/relief/exact_tracer.h"
#include "tests/support/instruction_sets.h"
#include "tests/support/temporary_folder.h"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iostream>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace kokage {
namespace {

class RandomRelief {
  public:
    explicit RandomRelief(std::uint32_t seed) : engine_(seed) {}

    float within(float low, float high) { return low + (high - low) * float(engine_() >> 8) * 0x1p-24f; }
    int below(int count) { return int(engine_() % std::uint32_t(count)); }

    /// Noise, waves, steps, one depth, or mostly one depth.
    HeightField field(int width, int height, HeightWrap wrap) {
        HeightField field{width, height, wrap, std::vector<float>(std::size_t(width) * std::size_t(height))};
        const int kind = below(5);
        const float level = below(3) == 0 ? 1.f : within(0, 1), waves = float(1 + below(5)),
                    roughness = within(0, 0.2f);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                float& depth = field.depths[std::size_t(y) * std::size_t(width) + std::size_t(x)];
                const float u = float(x) / float(width), v = float(y) / float(height);
                if (kind == 0)
                    depth = within(0, 1);
                else if (kind == 1)
                    depth = 0.5f + 0.4f * std::sin(6.2832f * waves * u) * std::cos(6.2832f * v) +
                            roughness * within(-0.5f, 0.5f);
                else if (kind == 2)
                    depth = float(int(u * waves + v * 3) % 3) / 2;
                else if (kind == 3)
                    depth = level;
                else
                    depth = below(20) == 0 ? within(0, 1) : level;
                depth = std::min(1.f, std::max(0.f, depth));
            }
        return field;
    }

    ReliefRay ray(const HeightField& field) {
        const auto sign = [&] { return below(2) ? 1.f : -1.f; };
        ReliefRay ray;
        ray.origin = {within(0, 1), within(0, 1), 0};
        const float angle = within(0, 6.2832f), tangent = std::exp(within(-5, 2));
        ray.direction = {tangent * std::cos(angle), tangent * std::sin(angle), 1};
        switch (below(16)) { // where it starts
        case 0:              // at a texel's border or centre
            ray.origin.x = (float(below(field.width)) + 0.5f * float(below(2))) / float(field.width);
            ray.origin.y = (float(below(field.height)) + 0.5f * float(below(2))) / float(field.height);
            break;
        case 1: // in the relief
            ray.origin.z = within(0, 1.2f);
            break;
        case 2: // above or below
            ray.origin.z = within(-3, 3);
            break;
        case 3: // many tiles away
            ray.origin.x = within(-1e6f, 1e6f);
            ray.origin.y = within(-100, 100);
            break;
        case 4:
            ray.origin.x = sign() * 1e-9f;
            ray.origin.y = float(below(3));
            break;
        default:
            break;
        }
        switch (below(16)) { // where it goes
        case 0:              // straight down or up
            ray.direction = {0, 0, sign()};
            break;
        case 1: // along an axis
            ray.direction[std::size_t(below(2))] = 0;
            break;
        case 2: // upwards
            ray.direction.z = -1;
            break;
        case 3: // almost parallel to the surface, or parallel
            ray.direction.z = below(2) ? 0 : sign() * std::exp(within(-8, 0)) * tangent;
            ray.origin.z = within(0, 1);
            if (below(32)) // the truth takes its time over the greatest number of tiles
                ray.t_most = within(0, 10) / tangent;
            break;
        case 4: // components that are next to nothing
            ray.direction[std::size_t(below(3))] = sign() * (below(2) ? 1e-40f : 1e-20f);
            if (below(32))
                ray.t_most = within(0, 10) / tangent;
            break;
        case 5: // units of any size
            ray.direction *= std::exp(within(-60, 60));
            break;
        case 6: // through corners of texels
            ray.direction.x = ray.direction.y * float(field.height) / float(field.width);
            break;
        default:
            break;
        }
        switch (below(40)) {
        case 0:
            ray.t_most = within(0, 1);
            break;
        case 1:
            ray.t_most = within(-1, 0);
            break;
        case 2:
            ray.t_most = std::numeric_limits<float>::quiet_NaN();
            break;
        case 3:
            ray.origin[std::size_t(below(3))] =
                below(2) ? std::numeric_limits<float>::quiet_NaN() : sign() * 1e38f * 10;
            break;
        case 4:
            ray.direction[std::size_t(below(3))] =
                below(2) ? std::numeric_limits<float>::quiet_NaN() : sign() * 1e38f * 10;
            break;
        case 5:
            ray.direction = glm::vec3(0);
            break;
        case 6: { // back from where a ray hits
            const TrueReliefHit hit = true_relief_hit(field, ray);
            if (hit.found()) {
                ray.origin = {glm::vec2(hit.coordinate), float(hit.depth) - (below(2) ? kShadowLift : 0)};
                ray.direction.z = -within(0.1f, 2);
            }
            break;
        }
        default:
            break;
        }
        return ray;
    }

  private:
    std::mt19937 engine_;
};

std::string text(const ReliefRay& ray) {
    char line[256];
    std::snprintf(line, sizeof line, "from (%.9g, %.9g, %.9g) along (%.9g, %.9g, %.9g) to %.9g", double(ray.origin.x),
                  double(ray.origin.y), double(ray.origin.z), double(ray.direction.x), double(ray.direction.y),
                  double(ray.direction.z), double(ray.t_most));
    return line;
}

/// Texels between the places of two hits on one ray.
double texels_between(const HeightField& field, const ReliefRay& ray, double t0, double t1) {
    const glm::dvec3 way = (t1 - t0) * glm::dvec3(ray.direction);
    return std::max(std::abs(way.x) * field.width, std::abs(way.y) * field.height);
}

/// What is wrong with a hit; empty: nothing.
std::string fault(const HeightField& field, const ReliefRay& ray, const ReliefHit& hit, const TrueReliefHit& truth) {
    if (hit.found() != truth.found())
        return truth.found() ? "misses the hit at " + std::to_string(truth.t)
                             : "hits nothing at " + std::to_string(hit.t);
    if (!hit.found())
        return {};
    const double rounding = 1e-6 * truth.t; // t is a float
    if (std::abs(hit.t - truth.t) > rounding && texels_between(field, ray, hit.t, truth.t) > 0.25)
        return "hits at " + std::to_string(hit.t) + " instead of " + std::to_string(truth.t);
    glm::dvec2 apart = glm::abs(glm::dvec2(hit.coordinate) - truth.coordinate);
    if (field.wrap == HeightWrap::repeat)
        apart = glm::min(apart, 1. - apart);
    const double far = 1e-6 * std::max({1., std::abs(truth.coordinate.x), std::abs(truth.coordinate.y)});
    if (apart.x > 0.25 / field.width + far || apart.y > 0.25 / field.height + far)
        return "hits another place";
    if (field.wrap == HeightWrap::repeat &&
        !(hit.coordinate.x >= 0 && hit.coordinate.x < 1 && hit.coordinate.y >= 0 && hit.coordinate.y < 1))
        return "hits beyond the tile";
    return {};
}

TEST(ReliefExact, FindsTheTrueHitsOfAnyRay) {
    constexpr std::uint32_t kSeed = 20;
    std::cout << "seed " << kSeed << '\n';
    RandomRelief random(kSeed);
    constexpr int kSizes[][2] = {{1, 1}, {1, 7}, {7, 1}, {2, 2}, {3, 5}, {37, 53}, {64, 64}, {256, 100}, {33, 128}};
    for (const auto& [width, height] : kSizes)
        for (const HeightWrap wrap : {HeightWrap::repeat, HeightWrap::clamp})
            for (int k = 0; k < 6; ++k) {
                const HeightField field = random.field(width, height, wrap);
                const auto tracer = make_exact_tracer(field);
                std::vector<ReliefRay> rays(1000);
                for (ReliefRay& ray : rays)
                    ray = random.ray(field);
                std::vector<TrueReliefHit> truth;
                for (const ReliefRay& ray : rays)
                    truth.push_back(true_relief_hit(field, ray));
                SCOPED_TRACE(std::to_string(width) + " x " + std::to_string(height) +
                             (wrap == HeightWrap::clamp ? " clamped, field " : ", field ") + std::to_string(k));
                test::with_every_instruction_set([&] {
                    std::vector<ReliefHit> hits(rays.size());
                    tracer->trace(rays, hits);
                    std::vector<std::uint8_t> hidden(rays.size(), 7);
                    std::vector<std::uint32_t> reads(rays.size());
                    tracer->occluded(rays, hidden, reads);
                    for (std::size_t r = 0; r < rays.size(); ++r) {
                        ASSERT_EQ(fault(field, rays[r], hits[r], truth[r]), "") << text(rays[r]);
                        ASSERT_EQ(hidden[r], truth[r].found()) << text(rays[r]);
                    }
                });
                ASSERT_FALSE(HasFailure());
            }
}

bool same_bits(const ReliefHit& a, const ReliefHit& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

TEST(ReliefExact, GivesARayTheSameHitWhateverIsBesideIt) {
    RandomRelief random(21);
    const HeightField field = random.field(64, 48, HeightWrap::repeat);
    const auto tracer = make_exact_tracer(field);
    std::vector<ReliefRay> rays(1000);
    for (ReliefRay& ray : rays)
        ray = random.ray(field);
    std::vector<ReliefHit> together(rays.size()), alone(rays.size()), backwards(rays.size());
    tracer->trace(rays, together);
    for (std::size_t r = 0; r < rays.size(); ++r)
        tracer->trace(std::span(rays).subspan(r, 1), std::span(alone).subspan(r, 1));
    const std::vector<ReliefRay> reversed(rays.rbegin(), rays.rend());
    tracer->trace(reversed, backwards);
    for (std::size_t r = 0; r < rays.size(); ++r) {
        EXPECT_TRUE(same_bits(together[r], alone[r])) << text(rays[r]);
        EXPECT_TRUE(same_bits(together[r], backwards[rays.size() - 1 - r])) << text(rays[r]);
    }
    tracer->trace({}, {});
}

TEST(ReliefExact, HitsAtTheTrueDepthAlongWallsOfATexel) {
    // Steep rays that run down beside a wall: a small part of a texel across is much depth.
    RandomRelief random(24);
    HeightField field{256, 256, HeightWrap::repeat, std::vector<float>(256 * 256)};
    for (float& depth : field.depths)
        depth = random.within(0, 1);
    const auto tracer = make_exact_tracer(field);
    std::vector<ReliefRay> rays(60000);
    for (ReliefRay& ray : rays) {
        const float angle = random.within(0, 6.2832f), tangent = random.within(0.001f, 0.06f);
        ray = {{random.within(0, 1), random.within(0, 1), 0},
               {tangent * std::cos(angle), tangent * std::sin(angle), 1}};
    }
    std::vector<ReliefHit> hits(rays.size());
    tracer->trace(rays, hits);
    for (std::size_t r = 0; r < rays.size(); ++r)
        EXPECT_NEAR(hits[r].t, true_relief_hit(field, rays[r]).t, 0.0015) << text(rays[r]);
    EXPECT_LT(tracer->doubtful_rays(), rays.size() / 50);
}

TEST(ReliefExact, LeavesFewRaysToDoublePrecision) {
    RandomRelief random(22);
    HeightField field = random.field(128, 128, HeightWrap::repeat);
    for (std::size_t k = 0; k < field.depths.size(); ++k)
        field.depths[k] = float(0.5 + 0.3 * std::sin(0.3 * double(k % 128)) * std::cos(0.2 * double(k / 128)));
    const auto tracer = make_exact_tracer(field);
    std::vector<ReliefRay> rays(20000);
    for (ReliefRay& ray : rays)
        ray = relief_ray({random.within(0, 1), random.within(0, 1)},
                         glm::normalize(glm::vec3(random.within(-1, 1), random.within(-1, 1), -0.3f)), {});
    std::vector<ReliefHit> hits(rays.size());
    tracer->trace(rays, hits);
    EXPECT_LT(tracer->doubtful_rays(), rays.size() / 200);
    double reads = 0, cells = 0;
    for (std::size_t r = 0; r < rays.size(); ++r) {
        reads += hits[r].reads;
        cells += true_relief_hit(field, rays[r]).reads;
    }
    EXPECT_LT(reads, cells / 2); // or the planes would serve for nothing
}

TEST(ReliefExact, RefusesFieldsThatCanNotBe) {
    EXPECT_THROW(make_exact_tracer({}), InputError);
    EXPECT_THROW(make_exact_tracer({2, 2, HeightWrap::repeat, {0, 0, 0}}), InputError);
    EXPECT_THROW(make_exact_tracer({1, 1, HeightWrap::repeat, {1.5f}}), InputError);
    EXPECT_THROW(make_exact_tracer({1, 1, HeightWrap::repeat, {std::numeric_limits<float>::quiet_NaN()}}), InputError);
    EXPECT_THROW(make_exact_tracer({1 << 15, 1, HeightWrap::repeat, std::vector<float>(1 << 15)}), InputError);
}

TEST(ReliefExact, LoadsWhatItStoredForTheSameFieldAlone) {
    const TemporaryFolder folder;
    const std::filesystem::path path = folder / "planes";
    RandomRelief random(23);
    HeightField field = random.field(37, 53, HeightWrap::clamp);
    const auto tracer = make_exact_tracer(field);
    tracer->store(path);
    const auto loaded = load_exact_tracer(field, path);
    EXPECT_EQ(loaded->bytes(), tracer->bytes());
    std::vector<ReliefRay> rays(500);
    for (ReliefRay& ray : rays)
        ray = random.ray(field);
    std::vector<ReliefHit> made(rays.size()), read(rays.size());
    tracer->trace(rays, made);
    loaded->trace(rays, read);
    for (std::size_t r = 0; r < rays.size(); ++r)
        EXPECT_TRUE(same_bits(made[r], read[r])) << text(rays[r]);

    const auto refused = [&](const HeightField& wanted, const char* reason) {
        try {
            load_exact_tracer(wanted, path);
            ADD_FAILURE() << "was loaded; expected: " << reason;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
            EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos) << error.what();
        }
    };
    HeightField other = field;
    other.depths[7] = other.depths[7] > 0.5f ? 0 : 1;
    refused(other, "another height field");
    other = field;
    other.wrap = HeightWrap::repeat;
    refused(other, "another height field");
    const auto size = std::filesystem::file_size(path);
    {
        std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(std::streamoff(size - 9));
        const int byte = file.peek();
        file.seekp(std::streamoff(size - 9));
        file.put(char(byte ^ 1));
    }
    refused(field, "altered");
    std::filesystem::resize_file(path, size - 16);
    refused(field, "truncated");
    std::filesystem::remove(path);
    refused(field, path.c_str());
}

} // namespace
} // namespace kokage
