#include "reflection/light_rays.h"

namespace kokage {

void LightRays::clear() {
    for (Rays& turn : of_turns_) {
        turn.rays.clear();
        turn.lights.clear();
    }
}

void LightRays::add(std::uint32_t receiver, const LightChoice& lights, const glm::vec3& point,
                    const Scattering& scattering, SampleIndex sample, ShadingScratch& scratch,
                    const ReliefPoint* relief) {
    choose_light_rays(lights, point, scattering, sample, scratch, relief);
    if (of_turns_.size() < scratch.rays.size())
        of_turns_.resize(scratch.rays.size());
    for (std::size_t k = 0; k < scratch.rays.size(); ++k) {
        const ShadowRay& ray = scratch.rays[k];
        of_turns_[k].rays.push_back({point, ray.direction, 0, ray.distance});
        of_turns_[k].lights.push_back({receiver, ray.radiance, ray.reflection});
    }
}

void LightRays::trace(const RayQueries& queries, std::span<LightFromLights> arrived) {
    for (Rays& turn : of_turns_) {
        for (Ray& ray : turn.rays)
            ray.near = queries.ray_offset();
        hidden_.resize(turn.rays.size());
        queries.occluded(turn.rays, hidden_);
        for (std::size_t k = 0; k < turn.rays.size(); ++k)
            if (!hidden_[k]) {
                LightFromLights& light = arrived[turn.lights[k].receiver];
                light.scattered += turn.lights[k].scattered;
                light.reflected += turn.lights[k].reflected;
            }
    }
}

} // namespace kokage
