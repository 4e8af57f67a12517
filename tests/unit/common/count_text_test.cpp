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

} // namespace
} // namespace kokage
