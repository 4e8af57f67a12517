#pragma once
// Vector code is compiled for several instruction sets: tests run each that this machine has.
#include <cstdint>
#include <gtest/gtest.h>
#include <hwy/targets.h>
#include <vector>

namespace kokage::test {

template <class Check>
void with_every_instruction_set(Check&& check) {
    const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
    ASSERT_FALSE(targets.empty());
    for (const std::int64_t target : targets) {
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().DeInit();
        SCOPED_TRACE(hwy::TargetName(target));
        check();
    }
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().DeInit();
}

} // namespace kokage::test
