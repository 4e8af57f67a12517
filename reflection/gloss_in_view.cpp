#include "reflection/gloss_in_view.h"
#include "reflection/view_frustum.h"

#include <algorithm>

namespace kokage {
namespace {

constexpr float kLeastUsual = 0.25f; ///< of plastics and leaves; all lobes down to mirrors' would take gigabytes

void add(const Gloss& gloss, RoughnessBounds& all) {
    const RoughnessBounds own = roughness_bounds(gloss);
    all.least = std::min(all.least, own.least);
    all.most = std::max(all.most, own.most);
}

} // namespace

RoughnessBounds roughness_in_view(const ShadedScene& scene, const CameraFrame& frame) {
    const ViewFrustum view(frame);
    const PatchScene& patches = *scene.patches;
    std::vector<bool> done;
    for (const SurfaceLook& look : scene.looks)
        done.push_back(look.gloss.is_matt());
    auto left = std::count(done.begin(), done.end(), false);
    RoughnessBounds all;
    for (std::size_t t = 0; t < scene.triangle_look.size() && left > 0; ++t) {
        const std::uint32_t look = scene.triangle_look[t];
        if (done[look])
            continue;
        const glm::uvec3 corners = patches.triangles[t];
        const glm::vec3 a = patches.positions[corners.x];
        const float radius =
            std::max(glm::distance(a, patches.positions[corners.y]), glm::distance(a, patches.positions[corners.z]));
        if (!view.may_see(a, radius + scene.looks[look].relief.depth_m))
            continue;
        add(scene.looks[look].gloss, all);
        done[look] = true;
        --left;
    }
    return all;
}

std::optional<RoughnessBounds> lobes_to_bake(const ShadedScene& scene, const CameraFrame& frame,
                                             const PictureSkips& skips, WorkReport& report) {
    const RoughnessBounds seen = roughness_in_view(scene, frame);
    const bool is_matt = seen.least > seen.most;
    if (is_matt && skips.bake_of_matt) {
        report.skips.push_back({"reflection map", "nothing glossy is in view", "one bake of the surroundings"});
        return std::nullopt;
    }
    if (is_matt || !skips.lobes_out_of_view)
        return RoughnessBounds{std::min(seen.least, kLeastUsual), 1, 1};
    return seen;
}

} // namespace kokage
