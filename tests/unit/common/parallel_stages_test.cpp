#include "common/services/parallel.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <gtest/gtest.h>
#include <numeric>
#include <stdexcept>
#include <thread>

namespace kokage {
namespace {

class ParallelStages : public testing::TestWithParam<int> {
  protected:
    void SetUp() override { set_thread_count(GetParam()); }
    void TearDown() override { set_thread_count(0); }
};
INSTANTIATE_TEST_SUITE_P(Threads, ParallelStages, testing::Values(1, 2, 4));

constexpr std::size_t kPlaces = 3;

TEST_P(ParallelStages, PassesEveryItemInOrderAndTakesNoMorePlacesThanItHas) {
    constexpr int kItems = 200;
    std::array<int, kPlaces> item{};
    std::array<std::atomic<bool>, kPlaces> taken{};
    std::atomic<int> in_second{0};
    int begun = 0, middle = 0;
    bool clash = false;
    std::vector<int> finished;
    parallel_stages(kPlaces,
                    [&](std::size_t place) {
                        if (begun == kItems)
                            return false;
                        clash |= place >= kPlaces || taken[place].exchange(true);
                        item[place] = begun++;
                        return true;
                    },
                    {[&](std::size_t place) {
                         clash |= in_second++ != 0 || item[place] != middle++;
                         // Parallel work within a stage is whole when the stage ends.
                         std::vector<int> squares(1000);
                         parallel_blocks(squares.size(), 10, [&](std::size_t begin, std::size_t end) {
                             for (std::size_t i = begin; i < end; ++i)
                                 squares[i] = int(i * i);
                         });
                         clash |= std::accumulate(squares.begin(), squares.end(), 0) != 332833500;
                         --in_second;
                     },
                     [&](std::size_t place) {
                         finished.push_back(item[place]);
                         taken[place] = false;
                     }});
    EXPECT_FALSE(clash);
    std::vector<int> expected(kItems);
    std::iota(expected.begin(), expected.end(), 0);
    EXPECT_EQ(finished, expected);
}

TEST_P(ParallelStages, ItemsBeforeOneThatThrowsGoToTheirEnd) {
    for (const std::size_t throwing_stage : {0u, 1u, 2u}) {
        int begun = 0;
        std::array<int, kPlaces> item{};
        std::vector<int> finished;
        const auto may_throw = [&](std::size_t stage, int number) {
            if (stage == throwing_stage && number == 7)
                throw std::runtime_error("seven");
        };
        try {
            parallel_stages(kPlaces,
                            [&](std::size_t place) {
                                may_throw(0, begun);
                                item[place] = begun++;
                                return begun < 100;
                            },
                            {[&](std::size_t place) { may_throw(1, item[place]); },
                             [&](std::size_t place) {
                                 may_throw(2, item[place]);
                                 std::this_thread::sleep_for(std::chrono::milliseconds(1));
                                 finished.push_back(item[place]);
                             }});
            ADD_FAILURE() << "nothing was thrown";
        } catch (const std::runtime_error& error) {
            EXPECT_STREQ(error.what(), "seven");
        }
        EXPECT_EQ(finished, (std::vector<int>{0, 1, 2, 3, 4, 5, 6})) << throwing_stage;
        EXPECT_LE(begun, 7 + int(kPlaces));
    }
}

TEST_P(ParallelStages, NothingToDoIsFine) {
    bool called = false;
    parallel_stages(kPlaces, [](std::size_t) { return false; }, {[&](std::size_t) { called = true; }});
    EXPECT_FALSE(called);
}

TEST(ParallelStagesAtOnce, WorkOnSeveralItems) {
    set_thread_count(2);
    if (thread_count() < 2)
        GTEST_SKIP() << "skipped: there is one core";
    // Each stage waits until the other one is at work, too, or for a second.
    std::atomic<int> at_work{0};
    std::atomic<bool> together{false};
    const auto meet = [&] {
        ++at_work;
        for (int i = 0; i < 1000 && !together; ++i) {
            if (at_work == 2)
                together = true;
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        --at_work;
    };
    int begun = 0;
    parallel_stages(kPlaces, [&](std::size_t) { return ++begun <= 5; },
                    {[&](std::size_t) { meet(); }, [&](std::size_t) { meet(); }});
    set_thread_count(0);
    EXPECT_TRUE(together);
}

} // namespace
} // namespace kokage
