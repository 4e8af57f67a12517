#include "reflection/maps/harmonics_file.h"

#include "common/services/error.h"
#include "common/services/random.h"
#include "tests/support/temporary_folder.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace kokage {
namespace {

TEST(HarmonicsFile, CoefficientsComeBackBitByBit) {
    const TemporaryFolder folder;
    Random random(2);
    std::vector<glm::vec3> coefficients(49);
    for (glm::vec3& c : coefficients)
        c = {random.uniform(-1, 1), std::exp(random.uniform(-30, 30)), 0};
    write_harmonics(folder / "sh.json", coefficients, "a \"sky\"");
    EXPECT_EQ(read_harmonics(folder / "sh.json"), coefficients);
}

TEST(HarmonicsFile, WhatIsWrongIsRefused) {
    const TemporaryFolder folder;
    const std::vector<glm::vec3> coefficients(9, glm::vec3(0.25f));
    write_harmonics(folder / "sh.json", coefficients);
    const std::string whole = read_text(folder / "sh.json");
    const auto with = [&](const std::string& text) {
        std::ofstream(folder / "bad.json") << text;
        return folder / "bad.json";
    };
    const auto replaced = [&](const std::string& from, const std::string& to) {
        std::string text = whole;
        text.replace(text.find(from), from.size(), to);
        return with(text);
    };
    for (std::size_t i = 0; i < 20; ++i)
        EXPECT_THROW(read_harmonics(with(whole.substr(0, (whole.size() - 2) * i / 20))), InputError);
    EXPECT_THROW(read_harmonics(replaced("\"version\": 1", "\"version\": 2")), InputError);
    EXPECT_THROW(read_harmonics(replaced("\"bands\": 3", "\"bands\": 4")), InputError);
    EXPECT_THROW(read_harmonics(replaced("0.25", "\"a\"")), InputError);
    EXPECT_THROW(read_harmonics(replaced("index l(l+1)+m", "index l")), InputError);
    EXPECT_THROW(read_harmonics(folder / "none.json"), InputError);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(write_harmonics(folder / "nan.json", std::vector{glm::vec3(nan)}), InputError);
}

} // namespace
} // namespace kokage
