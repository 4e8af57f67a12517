#include "common/services/error.h"
#include "common/services/random.h"
#include "tests/benchmark/radiance_code.h"
#include "tests/benchmark/reference.h"

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <unistd.h>

namespace kokage {
namespace {

class ReferenceFiles : public testing::Test {
  protected:
    void SetUp() override {
        const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
        folder_ = std::filesystem::path(testing::TempDir()) / ("kokage-" + name + std::to_string(::getpid()));
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::filesystem::path folder_;
};

TEST(RadianceCode, rounds_by_less_than_it_says) {
    Random random(3);
    double largest = 0;
    for (int i = 0; i < 200000; ++i) {
        const float value = std::exp2(random.uniform(-23.9f, 22.9f));
        const double back = radiance_from_code(radiance_code(value));
        largest = std::max(largest, std::abs(back / value - 1));
    }
    EXPECT_LE(largest, kRadianceCodeRounding + 1e-7);
    EXPECT_GT(largest, 0.9 * kRadianceCodeRounding) << "the bound is much larger than what happens";
    EXPECT_LE(kRadianceCodeRounding, 0.0005);
}

TEST(RadianceCode, keeps_the_order_and_black_and_refuses_what_it_can_not_hold) {
    EXPECT_EQ(radiance_code(0.f), 0);
    EXPECT_EQ(radiance_from_code(0), 0.f);
    EXPECT_EQ(radiance_code(0x1p-24f), 1);
    EXPECT_LT(radiance_code(0.5f), radiance_code(0.501f));
    EXPECT_GT(radiance_code(8388607.f), radiance_code(8000000.f)) << "wraps near the upper end";
    EXPECT_THROW(radiance_code(0x1p23f), InputError);
    EXPECT_THROW(radiance_code(-1e-3f), InputError);
    EXPECT_THROW(radiance_code(std::numeric_limits<float>::quiet_NaN()), InputError);
}

TEST_F(ReferenceFiles, come_back_as_they_were_saved) {
    Reference reference{0xfedcba9876543210ull, 8192, 0.00625, {}};
    Random random(5);
    for (int i = 0; i < 1000; ++i)
        reference.sides.push_back({random.uniform(), 0.01f * random.uniform(), 100.f * random.uniform()});
    save_reference(folder_ / "a", reference);
    const auto back = load_reference(folder_ / "a");
    ASSERT_TRUE(back);
    EXPECT_EQ(back->scene_hash, reference.scene_hash);
    EXPECT_EQ(back->paths_per_side, 8192u);
    EXPECT_EQ(back->noise, 0.00625);
    ASSERT_EQ(back->sides.size(), 1000u);
    for (std::size_t i = 0; i < 1000; ++i)
        for (glm::length_t c = 0; c < 3; ++c)
            EXPECT_NEAR(back->sides[i][c], reference.sides[i][c], reference.sides[i][c] * 0.00026f + 1e-7f);
    EXPECT_FALSE(load_reference(folder_ / "b"));
}

TEST_F(ReferenceFiles, damaged_ones_are_refused_by_name) {
    save_reference(folder_ / "a", {1, 64, 0.1, std::vector<glm::vec3>(10, glm::vec3(1))});
    std::filesystem::resize_file(folder_ / "a", std::filesystem::file_size(folder_ / "a") - 1);
    EXPECT_THROW(load_reference(folder_ / "a"), InputError);
    std::ofstream(folder_ / "b") << "kokage leaf side reference 1\n{\"scene_hash\":\"nonsense\"}\n";
    EXPECT_THROW(load_reference(folder_ / "b"), InputError);
    std::ofstream(folder_ / "c") << "something else";
    EXPECT_THROW(load_reference(folder_ / "c"), InputError);
}

TEST_F(ReferenceFiles, sums_go_on_only_for_their_own_scene) {
    ReferenceSums sums{7, 64, 3, {}};
    for (auto& half : sums.half)
        half.assign(10, glm::dvec3(3.0, 1.5, 0.3));
    save_sums(folder_ / "s", sums);
    const auto back = load_sums(folder_ / "s", 7, 64);
    ASSERT_TRUE(back);
    EXPECT_EQ(back->chunks, 3u);
    EXPECT_EQ(back->half[1], sums.half[1]);
    EXPECT_FALSE(load_sums(folder_ / "s", 8, 64)) << "another scene";
    EXPECT_FALSE(load_sums(folder_ / "s", 7, 32)) << "another chunk size";
    EXPECT_FALSE(load_sums(folder_ / "t", 7, 64)) << "no file";
    std::filesystem::resize_file(folder_ / "s", std::filesystem::file_size(folder_ / "s") - 8);
    EXPECT_FALSE(load_sums(folder_ / "s", 7, 64)) << "damaged";
}

TEST(ReferenceSumsNoise, is_the_error_of_the_mean_of_two_halves) {
    // Samples with a known truth: the noise that the halves tell must be the error that the mean has.
    constexpr std::size_t sides = 20000;
    constexpr std::uint64_t chunks = 16;
    ReferenceSums sums{1, 64, chunks, {}};
    Random random(11);
    for (auto& half : sums.half) {
        half.assign(sides, glm::dvec3(0.0));
        for (auto& side : half)
            for (std::uint64_t i = 0; i < chunks; ++i)
                for (glm::length_t c = 0; c < 3; ++c)
                    side[c] += 1.0 + 0.4 * (random.uniform_double() - 0.5);
    }
    const Reference reference = sums.reference();
    EXPECT_EQ(reference.paths_per_side, 2u * 64u * chunks);
    double error = 0;
    for (const glm::vec3& side : reference.sides)
        error += (std::abs(side.x - 1) + std::abs(side.y - 1) + std::abs(side.z - 1)) / 3.0 / sides;
    EXPECT_NEAR(reference.noise / error, 1.0, 0.03);
}

} // namespace
} // namespace kokage
