#pragma once
// Chooses one of an environment's split-off lights for a shadow ray.
#include "common/environment/environment.h"

#include <optional>
#include <vector>

namespace kokage {

/// Where a shadow ray goes and what it brings.
struct LightRay {
    glm::vec3 direction;
    float distance;                        ///< INFINITY for lights at infinity
    glm::vec3 irradiance;                  ///< on a facing surface, unshadowed, over the probability of the choice
    const DistantLight* distant = nullptr; ///< that was chosen; null for a point light
};

/// Chooses in proportion to a bound of what each light brings, so that 64 lights cost one shadow ray a vertex and
/// lights that can't be seen cost none. Looks at every light each time. Thread-safe; the environment must outlive it.
class LightSampler {
  public:
    explicit LightSampler(const Environment& environment);
    bool empty() const { return distant_.empty() && points_.empty(); }
    /// A light for a point that takes `front` of the irradiance on the side of `normal` and `back` of that on the other
    /// side. Nothing if no light can reach either side. `choice` and `numbers` are uniform in [0, 1).
    std::optional<LightRay> sample(const glm::vec3& point, const glm::vec3& normal, const glm::vec3& front,
                                   const glm::vec3& back, float choice, glm::vec2 numbers) const;

  private:
    struct Distant;
    static LightSample sample_distant(const Distant& light, glm::vec2 numbers);
    static float bound(const Distant& light, const glm::vec3& normal, const glm::vec3& front, const glm::vec3& back);
    std::optional<LightRay> only_light(const glm::vec3& normal, const glm::vec3& front, const glm::vec3& back,
                                       glm::vec2 numbers) const;

    struct Distant {
        glm::vec3 direction, irradiance;
        float cos_half, sin_half; ///< of the cone that holds it
        const DistantLight* light;
        std::vector<double> texel_shares; ///< cumulative; empty for a disc
    };
    struct Point {
        glm::vec3 position;
        glm::dvec3 intensity;
    };
    std::vector<Distant> distant_;
    std::vector<Point> points_;
};

} // namespace kokage
