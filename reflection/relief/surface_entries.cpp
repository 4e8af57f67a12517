#include "reflection/relief/surface_entries.h"

namespace kokage {

void trace_from_outside(const SurfaceRelief& surface, std::span<const SurfaceRay> rays, const NextSurfaceEntry& next,
                        const std::function<float(std::size_t ray, float distance)>& strength,
                        std::span<SurfaceHit> hits) {
    std::vector<std::size_t> going(rays.size());
    std::vector<float> after(rays.size(), 0.f);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        going[i] = i;
        hits[i] = {};
    }
    std::vector<SurfaceRay> entering;
    std::vector<SurfaceHit> found;
    while (!going.empty()) {
        entering.clear();
        std::erase_if(going, [&](std::size_t i) {
            SurfaceEntry entry;
            if (!next(i, after[i], hits[i].distance, entry))
                return true;
            SurfaceRay ray = rays[i];
            ray.triangle = entry.triangle;
            ray.distance = after[i] = entry.distance;
            ray.strength = strength(i, entry.distance);
            entering.push_back(ray);
            return false;
        });
        found.resize(entering.size());
        surface.trace(entering, found);
        for (std::size_t k = 0; k < found.size(); ++k) {
            SurfaceHit& best = hits[going[k]];
            const std::uint32_t reads = best.reads + found[k].reads, tetrahedra = best.tetrahedra + found[k].tetrahedra;
            if (found[k].distance < best.distance || !best.found())
                best = found[k];
            best.reads = reads;
            best.tetrahedra = tetrahedra;
        }
    }
}

} // namespace kokage
