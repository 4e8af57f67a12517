// First hits along sampling directions, on large maps, and eq 2 of [D], which shrinks them.
#include "common/services/parallel.h"
#include "reflection/relief/depth_maps.h"

#include <algorithm>
#include <vector>

namespace kokage {
namespace {

constexpr int kLeastTracedSize = 256;

int traced_size(const DepthMapSettings& settings) {
    int size = settings.size;
    while (settings.traced_size == 0 && size < kLeastTracedSize)
        size *= 2;
    return std::max(size, settings.traced_size);
}

/// Eq 2: t'[x, y] is the least of t[2x..2x+1, 2y..2y+1].
void halve(std::vector<float>& map, int& size) {
    const std::size_t wide = std::size_t(size), half = wide / 2;
    for (std::size_t y = 0; y < half; ++y)
        for (std::size_t x = 0; x < half; ++x) {
            const float* block = &map[2 * y * wide + 2 * x];
            map[y * half + x] = std::min({block[0], block[1], block[wide], block[wide + 1]});
        }
    size /= 2;
    map.resize(half * half);
}

/// Depths of the hits of parallel rays through the middles of a map's texels.
std::vector<float> first_hits(const ReliefTracer& source, const glm::dvec2& slope, int size, Progress& progress) {
    const std::size_t wide = std::size_t(size);
    std::vector<float> depths(wide * wide);
    std::vector<ReliefRay> rays(wide);
    std::vector<ReliefHit> hits(wide);
    for (std::size_t y = 0; y < wide; ++y) {
        if (y % 16 == 0)
            progress.throw_if_stopped();
        const float v = (float(y) + 0.5f) / float(size);
        for (std::size_t x = 0; x < wide; ++x)
            rays[x] = {{(float(x) + 0.5f) / float(size), v, 0}, {float(slope.x), float(slope.y), 1}};
        source.trace(rays, hits);
        for (std::size_t x = 0; x < wide; ++x) // t is depth; who crosses 1024 tiles without a hit says nothing
            depths[y * wide + x] = hits[x].found() ? std::clamp(hits[x].t, 0.f, 1.f) : 0.f;
    }
    return depths;
}

} // namespace

DepthMaps trace_depth_maps(const DepthMapSettings& settings, const ReliefTracer& source, Progress& progress) {
    settings.check();
    const std::size_t texels = std::size_t(settings.size) * std::size_t(settings.size);
    LargeVector<std::uint8_t> depths(texels * std::size_t(settings.maps()));
    // All sectors of ring 0 look straight down: one map serves them.
    const std::size_t sectors = std::size_t(settings.azimuths), traced = std::size_t(settings.maps()) - sectors + 1;
    progress.begin("tracing depth maps", traced);
    parallel_blocks(traced, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const std::size_t first = k == 0 ? 0 : k + sectors - 1, last = k == 0 ? sectors : first + 1;
            int size = traced_size(settings);
            std::vector<float> map =
                first_hits(source, relief_slope(settings.scale, sampling_slope(settings, int(first))), size, progress);
            while (size > settings.size)
                halve(map, size);
            for (std::size_t copy = first; copy < last; ++copy)
                std::transform(map.begin(), map.end(), depths.begin() + std::ptrdiff_t(copy * texels),
                               [](float depth) { return std::uint8_t(depth * 255.f); });
            progress.advance(1);
        }
    });
    return DepthMaps(DepthMapKind::first_hits, settings, std::move(depths));
}

} // namespace kokage
