#include "common/services/number_text.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

TEST(NumberText, IsAsShortAsItReadsBack) {
    EXPECT_EQ(number_text(0.1), "0.1");
    EXPECT_EQ(number_text(-8.5), "-8.5");
    EXPECT_EQ(number_text(7), "7");
    for (const double value : {1.0 / 3, 1e300, 5e-324, -1.7976931348623157e308, -123456.789})
        EXPECT_EQ(number_from_text(number_text(value)), value);
}

TEST(NumberText, IsNothingForWhatIsNoFiniteNumber) {
    for (const char* text : {"", "x", "1x", " 1", "inf", "nan", "1e999", "1,5"})
        EXPECT_FALSE(number_from_text(text)) << text;
}

} // namespace
} // namespace kokage
