#pragma once
// How light changes over a flat patch: a line through what its rays gathered, by ridge regression (Hoerl and Kennard
// 1970). Private to reflection.
#include "common/types.h"
#include "reflection/values_of_some.h"

namespace kokage {

/// Light at a point over its mean: 1 + slope (point - centre), within bounds.
struct PatchGradient {
    glm::vec3 centre{0.f};
    glm::vec3 slope{0.f}; ///< per metre
    float at(const glm::vec3& point) const;
};

/// Sums over the rays of one patch's side.
class PatchMoments {
  public:
    /// `origin`: any point of the patch, so that a tree far from the origin keeps its digits.
    explicit PatchMoments(const glm::vec3& origin) : origin_(origin) {}
    /// `light` of a ray from `point`: luminance.
    void add(const glm::vec3& point, float light);
    /// Flat where there are too few rays for their noise to tell a slope. The prior is that light changes by about 0.2
    /// of its mean over the patch.
    PatchGradient gradient() const;

  private:
    glm::vec3 origin_;
    glm::dvec3 points_{0.}, lights_of_points_{0.};
    glm::dmat3 products_{0.};
    double count_ = 0, lights_ = 0, squares_ = 0;
};

/// Gradients of some of many places.
class PatchGradients {
  public:
    void set(std::size_t places, std::uint32_t place, const PatchGradient& gradient);
    /// 1 where none was set.
    float at(std::uint32_t place, const glm::vec3& point) const {
        const PatchGradient* gradient = place < gradients_.places() ? gradients_.find(place) : nullptr;
        return gradient ? gradient->at(point) : 1.f;
    }
    static double most_bytes(double places, double set) { return ValuesOfSome<PatchGradient>::most_bytes(places, set); }

  private:
    ValuesOfSome<PatchGradient> gradients_;
};

} // namespace kokage
