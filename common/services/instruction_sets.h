#pragma once
// Vector code by Google Highway is compiled once for every instruction set, and the best that a machine has is chosen
// at run time. Which of them: include this before <hwy/foreach_target.h>.

// Some of it holds arrays of vectors, which the sizeless vectors of SVE and RVV can't be in; Arm has NEON for it.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
