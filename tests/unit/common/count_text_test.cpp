#include "common/services/count_text.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

TEST(CountText, GroupsThousands) {
    EXPECT_EQ(count_text(0), "0");
    EXPECT_EQ(count_text(1000), "1,000");
    EXPECT_EQ(count_text(123456789), "123,456,789");
}

TEST(CountText, OneIsNotMany) {
    EXPECT_EQ(counted(0, "leaf", "leaves"), "0 leaves");
    EXPECT_EQ(counted(1, "leaf", "leaves"), "1 leaf");
    EXPECT_EQ(counted(30000, "leaf", "leaves"), "30,000 leaves");
}

TEST(CountText, LengthsAndAreasTakeTheUnitThatSuitsThem) {
    EXPECT_EQ(length_text(0), "0 m");
    EXPECT_EQ(length_text(2e-7), "0.0002 mm");
    EXPECT_EQ(length_text(0.00163), "1.63 mm");
    EXPECT_EQ(length_text(0.4296), "43 cm");
    EXPECT_EQ(length_text(0.997), "0.997 m");
    EXPECT_EQ(length_text(12.44), "12.4 m");
    EXPECT_EQ(length_text(5058.3), "5,058 m");
    EXPECT_EQ(length_text(2e12), "2e+12 m");
    EXPECT_EQ(area_text(0), "0 m2");
    EXPECT_EQ(area_text(3.2e-6), "3.2 mm2");
    EXPECT_EQ(area_text(0.00829), "82.9 cm2");
    EXPECT_EQ(area_text(2.2164), "2.216 m2");
    EXPECT_EQ(area_text(8290.4), "8,290 m2");
    EXPECT_EQ(area_text(4974123), "4,974,123 m2");
}

} // namespace
} // namespace kokage
