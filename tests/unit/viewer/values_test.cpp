#include "common/services/error.h"
#include "viewer/scene/values.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

TEST(Values, NumbersAreReadWhole) {
    EXPECT_EQ(numbers_from("0.5", "--x"), std::vector<double>({0.5}));
    EXPECT_EQ(numbers_from("-1, +2e3,3", "--x"), std::vector<double>({-1, 2000, 3}));
    for (const char* wrong : {"", ",", "1,", "1;2", "one", "1,,2", "nan", "inf", "1e999", "1 2"})
        EXPECT_THROW(numbers_from(wrong, "--x"), InputError) << wrong;
}

TEST(Values, ColorsHaveOneOrThreeNumbersInRange) {
    EXPECT_EQ(color_from("0.25", "--x"), glm::vec3(0.25f));
    EXPECT_EQ(color_from("0,0.5,1", "--x"), glm::vec3(0, 0.5f, 1));
    EXPECT_EQ(color_from("20", "--x", 100.f), glm::vec3(20));
    for (const char* wrong : {"0.1,0.2", "0.1,0.2,0.3,0.4", "-0.1", "1.01"})
        EXPECT_THROW(color_from(wrong, "--x"), InputError) << wrong;
}

TEST(Values, SizesAreWholeAndBounded) {
    EXPECT_EQ(size_from("1280x960", "--x").width, 1280);
    EXPECT_EQ(size_from("1X32768", "--x").height, 32768);
    for (const char* wrong : {"1280", "0x10", "10x", "x10", "1.5x2", "40000x10", "10x10x10", "-1x4"})
        EXPECT_THROW(size_from(wrong, "--x"), InputError) << wrong;
}

TEST(Values, MessagesNameTheOptionAndTheValue) {
    try {
        size_from("huge", "--image-size");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(std::string(error.what()),
                  "--image-size: 'huge' is not a size such as 1280x960 (each from 1 to 32768)");
    }
}

TEST(Values, TextsForPeople) {
    EXPECT_EQ(duration_text(0.0123), "12 ms");
    EXPECT_EQ(duration_text(0.9999), "1.00 s");
    EXPECT_EQ(duration_text(125), "2 min 05 s");
    EXPECT_EQ(bytes_text(999), "999 B");
    EXPECT_EQ(bytes_text(1234567), "1.2 MB");
    EXPECT_EQ(bytes_text(45.6e6), "46 MB");
}

} // namespace
} // namespace kokage
