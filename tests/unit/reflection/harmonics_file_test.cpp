#include "reflection/maps/harmonics_file.h"

#include "common/services/error.h"
#include "common/services/random.h"
#include "tests/support/temporary_folder.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace kokage {
namespace {

Harmonics some_harmonics(std::size_t count) {
    Random random(2);
    Harmonics harmonics;
    harmonics.quantity = HarmonicQuantity::irradiance;
    harmonics.coefficients.resize(count);
    for (glm::vec3& c : harmonics.coefficients)
        c = {random.uniform(-1, 1), std::exp(random.uniform(-30, 30)), 0};
    harmonics.lights.push_back({"the \"sun\"", glm::normalize(glm::vec3(1, 2, 3)), 0.00465f, {3e4f, 1e-7f, 0}});
    return harmonics;
}

TEST(HarmonicsFile, EverythingComesBackBitByBit) {
    const TemporaryFolder folder;
    const Harmonics written = some_harmonics(49);
    write_harmonics(folder / "sh.json", written, "a \"sky\"");
    const HarmonicsFile read = read_harmonics(folder / "sh.json");
    EXPECT_EQ(read.made_from, "a \"sky\"");
    EXPECT_EQ(read.harmonics.quantity, HarmonicQuantity::irradiance);
    EXPECT_EQ(read.harmonics.coefficients, written.coefficients);
    ASSERT_EQ(read.harmonics.lights.size(), 1u);
    EXPECT_EQ(read.harmonics.lights[0].name, "the \"sun\"");
    EXPECT_EQ(read.harmonics.lights[0].direction, written.lights[0].direction);
    EXPECT_EQ(read.harmonics.lights[0].half_angle, written.lights[0].half_angle);
    EXPECT_EQ(read.harmonics.lights[0].irradiance, written.lights[0].irradiance);
}

TEST(HarmonicsFile, WhatIsWrongIsRefused) {
    const TemporaryFolder folder;
    Harmonics harmonics = some_harmonics(9);
    harmonics.coefficients.assign(9, glm::vec3(0.25f));
    write_harmonics(folder / "sh.json", harmonics);
    const std::string whole = read_text(folder / "sh.json");
    const auto with = [&](const std::string& text) {
        std::ofstream(folder / "bad.json") << text;
        return folder / "bad.json";
    };
    for (std::size_t i = 0; i < 20; ++i)
        EXPECT_THROW(read_harmonics(with(whole.substr(0, (whole.size() - 2) * i / 20))), InputError);
    const std::pair<const char*, const char*> changes[] = {{"\"version\": 2", "\"version\": 1"},
                                                           {"\"bands\": 3", "\"bands\": 4"},
                                                           {"\"bands\": 3", "\"bands\": 3e9"},
                                                           {"\"bands\": 3", "\"bands\": -3"},
                                                           {"0.25", "\"a\""},
                                                           {"0.25", "1e99"},
                                                           {"index l(l+1)+m", "index l"},
                                                           {"\"irradiance\"", "\"light\""},
                                                           {"\"half_angle\"", "\"angle\""},
                                                           {"0.26726", "1.26726"},
                                                           {"\"lights\"", "\"lamps\""},
                                                           {"\"name\": \"the", "\"name\": 3, \"x\": \"the"}};
    for (const auto& [from, to] : changes) {
        std::string text = whole;
        ASSERT_NE(text.find(from), std::string::npos) << from;
        text.replace(text.find(from), std::string(from).size(), to);
        EXPECT_THROW(read_harmonics(with(text)), InputError) << from << " " << to;
    }
    EXPECT_THROW(read_harmonics(folder / "none.json"), InputError);
    harmonics.coefficients[3].y = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(write_harmonics(folder / "nan.json", harmonics), InputError);
    EXPECT_FALSE(std::filesystem::exists(folder / "nan.json"));
}

} // namespace
} // namespace kokage
