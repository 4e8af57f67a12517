#pragma once
// Which of a square's rays look alike, where coverage rays tell how much of the square each kind of thing takes: what
// the shaded rays of a class show stands for all of it. Private to reflection.
#include "reflection/seen_by_ray.h"

#include <span>
#include <vector>

namespace kokage {

/// A first ray that is not shaded.
struct CoverageRay {
    glm::vec2 place{0.5f};  ///< in its pixel, from the upper left corner
    std::uint32_t part = 0; ///< that it met: SeenByRay's
};

/// Surroundings and ground are classes, and every part of a surface that is so large that two shaded rays should have
/// met it. All smaller parts are one class: which of them shaded rays meet is chance, so that each by itself would
/// count too much where it is met, and nothing where it isn't. All rays decide together: they are spread
/// evenly, so that what some of them met too often the others met too rarely.
class CoverageClasses {
  public:
    /// `shaded`: parts that the shaded rays met.
    CoverageClasses(std::span<const CoverageRay> coverage, std::span<const std::uint32_t> shaded);

    /// Any number that is the same for parts of a class.
    std::uint32_t of(std::uint32_t part) const;

  private:
    std::vector<std::uint32_t> large_; ///< parts
};

/// The first of `coverage` of each class that none of the parts `shaded` belongs to.
std::vector<std::size_t> rays_of_unshaded_classes(const CoverageClasses& classes, std::span<const CoverageRay> coverage,
                                                  std::span<const std::uint32_t> shaded);

} // namespace kokage
