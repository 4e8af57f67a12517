#pragma once
// Which methods are measured on which scenes with which efforts.
#include "foliage/method.h"
#include "tests/benchmark/foliage_scenes.h"

#include <string>
#include <vector>

namespace kokage {

struct PlannedEffort {
    Method method = Method::bundles;
    std::string kind; ///< "directions", "paths", "maps", or "asked error"
    double value = 0;
};

struct PlannedScene {
    BenchSceneName name;
    std::vector<PlannedEffort> efforts;
};

/// The whole benchmark, or the part of it that ends within two minutes on two cores.
std::vector<PlannedScene> benchmark_plan(bool quick);

/// What a method is asked for at an effort.
ShadingOptions shading_options(const PlannedEffort& effort);

} // namespace kokage
