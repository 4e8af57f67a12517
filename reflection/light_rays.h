#pragma once
// Shadow rays of many points, traced together: packets of rays that go to one light from neighbouring points cost less
// than half of what as many single rays do. Private to reflection.
#include "common/trace/ray_queries.h"
#include "reflection/surface_shading.h"

#include <span>
#include <vector>

namespace kokage {

class LightRays {
  public:
    void clear();
    /// Chooses the rays from `point` to lights, as light_from_lights does.
    void add(std::uint32_t receiver, const LightChoice& lights, const glm::vec3& point, const Scattering& scattering,
             SampleIndex sample, ShadingScratch& scratch, const ReliefPoint* relief = nullptr);
    /// Adds what arrives to `arrived[receiver]`.
    void trace(const RayQueries& queries, std::span<LightFromLights> arrived);

  private:
    struct Light {
        std::uint32_t receiver;
        glm::vec3 scattered, reflected;
    };
    /// Of the n-th ray of every point: mostly all to one light.
    struct Rays {
        std::vector<Ray> rays;
        std::vector<Light> lights;
    };
    std::vector<Rays> of_turns_;
    std::vector<std::uint8_t> hidden_;
};

} // namespace kokage
