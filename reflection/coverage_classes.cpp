#include "reflection/coverage_classes.h"

#include <algorithm>

namespace kokage {
namespace {

constexpr std::size_t kShadedOfLarge = 2;
constexpr std::uint32_t kSmallSurfaces = ~0u;

} // namespace

CoverageClasses::CoverageClasses(std::span<const CoverageRay> coverage, std::span<const std::uint32_t> shaded) {
    struct Count {
        std::uint32_t part;
        std::size_t rays;
    };
    std::vector<Count> counts; // a square shows few parts: looking through them all is faster than sorting
    const auto count = [&](std::uint32_t part) {
        for (Count& known : counts)
            if (known.part == part) {
                ++known.rays;
                return;
            }
        counts.push_back({part, 1});
    };
    for (const CoverageRay& ray : coverage)
        count(ray.part);
    for (const std::uint32_t part : shaded)
        count(part);
    for (const Count& known : counts)
        if (known.rays * shaded.size() >= kShadedOfLarge * (coverage.size() + shaded.size()))
            large_.push_back(known.part);
}

std::uint32_t CoverageClasses::of(std::uint32_t part) const {
    const bool is_class =
        part < seen_part::kFirstSurface || std::find(large_.begin(), large_.end(), part) != large_.end();
    return is_class ? part : kSmallSurfaces;
}

std::vector<std::size_t> rays_of_unshaded_classes(const CoverageClasses& classes, std::span<const CoverageRay> coverage,
                                                  std::span<const std::uint32_t> shaded) {
    std::vector<std::uint32_t> known;
    for (const std::uint32_t part : shaded)
        known.push_back(classes.of(part));
    std::vector<std::size_t> rays;
    for (std::size_t k = 0; k < coverage.size(); ++k)
        if (const std::uint32_t of = classes.of(coverage[k].part);
            std::find(known.begin(), known.end(), of) == known.end()) {
            known.push_back(of);
            rays.push_back(k);
        }
    return rays;
}

} // namespace kokage
