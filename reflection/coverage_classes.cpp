#include "reflection/coverage_classes.h"

#include <algorithm>

namespace kokage {
namespace {

constexpr std::size_t kShadedOfLarge = 2;
constexpr std::uint32_t kSmallSurfaces = ~0u;

} // namespace

CoverageClasses::CoverageClasses(std::span<const CoverageRay> coverage, std::span<const std::uint32_t> shaded) {
    std::vector<std::uint32_t> parts(shaded.begin(), shaded.end());
    for (const CoverageRay& ray : coverage)
        parts.push_back(ray.part);
    std::sort(parts.begin(), parts.end());
    for (std::size_t begin = 0, end = 0; begin < parts.size(); begin = end) {
        while (end < parts.size() && parts[end] == parts[begin])
            ++end;
        if ((end - begin) * shaded.size() >= kShadedOfLarge * parts.size())
            large_.push_back(parts[begin]);
    }
}

std::uint32_t CoverageClasses::of(std::uint32_t part) const {
    const bool is_class = part < seen_part::kFirstSurface || std::binary_search(large_.begin(), large_.end(), part);
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
