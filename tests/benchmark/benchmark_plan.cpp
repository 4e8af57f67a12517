#include "tests/benchmark/benchmark_plan.h"

#include <initializer_list>

namespace kokage {

namespace {

/// A list of efforts, method by method.
class Efforts {
  public:
    Efforts& bundles(std::initializer_list<double> directions) {
        return add(Method::bundles, "directions", directions);
    }
    Efforts& asked(std::initializer_list<double> errors) { return add(Method::bundles, "asked error", errors); }
    Efforts& paths(std::initializer_list<double> a_side) { return add(Method::path_traced, "paths", a_side); }
    Efforts& light_maps(std::initializer_list<double> maps) { return add(Method::light_maps, "maps", maps); }
    Efforts& paper(std::initializer_list<double> maps) { return add(Method::paper, "maps", maps); }
    operator std::vector<PlannedEffort>() const { return list_; }

  private:
    Efforts& add(Method method, const char* kind, std::initializer_list<double> values) {
        for (double value : values)
            list_.push_back({method, kind, value});
        return *this;
    }
    std::vector<PlannedEffort> list_;
};

std::vector<PlannedScene> quick_plan() {
    using enum BenchLight;
    using enum BenchMaterial;
    return {
        // efforts on both sides of 6 % of error
        {{sky_sun, 30000, realistic},
         Efforts().bundles({16, 24, 32, 36, 40, 48}).paths({64, 80}).light_maps({15}).paper({15})},
        {{sky_sun, 30000, bright},
         Efforts().bundles({8, 10, 12, 14, 16, 20}).paths({32, 64}).light_maps({15}).paper({15})},
        {{lamp_lit, 30000, realistic}, Efforts().bundles({16, 32, 48}).paths({64})},
        {{furnace, 30000, BenchMaterial::white}, Efforts().bundles({32})},
        {{sky_sun, 5000, realistic}, Efforts().bundles({32}).paths({64}).light_maps({15}).paper({15})},
    };
}

std::vector<PlannedScene> full_plan() {
    using enum BenchLight;
    using enum BenchMaterial;
    std::vector<PlannedScene> plan;
    for (BenchLight light : {sky_sun, lamp_lit})
        for (BenchMaterial material : {realistic, bright}) {
            plan.push_back({{light, 30000, material},
                            Efforts()
                                .bundles({8, 10, 12, 14, 16, 24, 32, 36, 40, 48, 64, 128})
                                .asked({0.1, 0.05, 0.03})
                                .paths({16, 32, 64, 80, 128, 256})
                                .light_maps({15, 100})
                                .paper({15, 100, 1000})});
            plan.push_back({{light, 5000, material},
                            Efforts()
                                .bundles({8, 16, 24, 32, 48, 64, 128})
                                .paths({16, 64, 128, 256})
                                .light_maps({15, 100})
                                .paper({15, 100})});
            plan.push_back({{light, 150000, material},
                            Efforts().bundles({16, 32, 64}).paths({16, 64}).light_maps({15, 100}).paper({15, 100})});
        }
    plan.push_back({{sky_sun_relit, 30000, realistic}, Efforts().bundles({8, 16, 24, 32, 48, 64, 128})});
    plan.push_back({{one_light, 5000, realistic}, Efforts().bundles({8, 16, 24, 32, 48, 64, 128}).paths({64})});
    plan.push_back({{many_lights, 5000, realistic}, Efforts().bundles({8, 16, 24, 32, 48, 64, 128}).paths({64})});
    plan.push_back({{point_light, 5000, realistic},
                    Efforts().bundles({16, 32, 64, 128}).paths({16, 64, 128, 256}).light_maps({15}).paper({15})});
    plan.push_back({{furnace, 30000, BenchMaterial::white},
                    Efforts().bundles({16, 32, 64}).paths({16}).light_maps({15}).paper({15})});
    return plan;
}

} // namespace

std::vector<PlannedScene> benchmark_plan(bool quick) {
    return quick ? quick_plan() : full_plan();
}

ShadingOptions shading_options(const PlannedEffort& effort) {
    ShadingOptions options;
    options.method = effort.method;
    if (effort.kind == "asked error")
        options.error = effort.value;
    else if (effort.kind == "maps")
        options.maps = int(effort.value);
    else
        options.effort = int(effort.value);
    return options;
}

} // namespace kokage
