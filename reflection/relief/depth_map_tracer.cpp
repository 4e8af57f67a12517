#include "reflection/relief/depth_map_tracer.h"
#include "common/services/error.h"
#include "reflection/relief/depth_map_search.h"
#include "reflection/relief/lane_tracer.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace kokage {
namespace {

constexpr int kMostSteps = 4096, kMostBisections = 24;
constexpr float kBoundMargin = 0x1p-14f; ///< of depth: rays begin that much above their bound

class DepthMapTracer final : public LaneTracer<ReliefTracer> {
  public:
    DepthMapTracer(const HeightField& field, DepthMaps maps, const DepthMapSearch& search)
        : LaneTracer(field), padded_(field), maps_(std::move(maps)), table_(maps_), search_(search) {}

    std::size_t bytes() const override { return padded_.bytes() + maps_.bytes(); }

  private:
    void search(std::span<const ReliefRay> rays, const LaneResults& results) const override {
        search_depth_maps(padded_, table_, search_, rays, results);
    }

    PaddedDepths padded_;
    DepthMaps maps_;
    DepthMapTable table_;
    DepthMapSearch search_;
};

class ConservativeTracer final : public ReliefTracer {
  public:
    ConservativeTracer(HeightWrap wrap, DepthMaps maps, std::unique_ptr<ReliefTracer> exact)
        : wrap_(wrap), maps_(std::move(maps)), table_(maps_), exact_(std::move(exact)) {}

    void trace(std::span<const ReliefRay> rays, std::span<ReliefHit> hits) const override {
        for_blocks(rays, [&](std::size_t first, const Block& block, std::span<const ReliefRay> moved) {
            const std::span<ReliefHit> to = hits.subspan(first, moved.size());
            exact_->trace(moved, to);
            for (std::size_t k = 0; k < to.size(); ++k) {
                to[k].t = float(double(to[k].t) + block.skipped[k]);
                to[k].reads += block.reads[k];
            }
        });
    }
    void occluded(std::span<const ReliefRay> rays, std::span<std::uint8_t> hidden,
                  std::span<std::uint32_t> reads) const override {
        // Most go upwards to a light, for which maps of what is hit from above are no help: they begin where they do.
        for_blocks(rays, [&](std::size_t first, const Block& block, std::span<const ReliefRay> moved) {
            const std::span<std::uint32_t> counts =
                reads.empty() ? std::span<std::uint32_t>{} : reads.subspan(first, moved.size());
            exact_->occluded(moved, hidden.subspan(first, moved.size()), counts);
            for (std::size_t k = 0; k < counts.size(); ++k)
                counts[k] += block.reads[k];
        });
    }
    std::size_t bytes() const override { return exact_->bytes() + maps_.bytes(); }

  private:
    static constexpr std::size_t kBlock = 4096;
    struct Block {
        std::vector<ReliefRay> moved = std::vector<ReliefRay>(kBlock);
        std::vector<double> skipped = std::vector<double>(kBlock); ///< t
        std::vector<std::uint8_t> reads = std::vector<std::uint8_t>(kBlock);
    };

    template <class Body>
    void for_blocks(std::span<const ReliefRay> rays, Body&& body) const {
        Block block;
        std::vector<float> bounds(kBlock);
        for (std::size_t first = 0; first < rays.size(); first += kBlock) {
            const auto given = rays.subspan(first, std::min(kBlock, rays.size() - first));
            read_bounds(table_, wrap_, given, bounds.data());
            for (std::size_t k = 0; k < given.size(); ++k) {
                block.reads[k] = bounds[k] >= 0;
                block.skipped[k] = move_to(given[k], bounds[k] - kBoundMargin, block.moved[k]);
            }
            body(first, block, std::span<const ReliefRay>(block.moved.data(), given.size()));
        }
    }

    /// The ray, begun at a depth below its origin; returns the t that it leaves out.
    double move_to(const ReliefRay& ray, float depth, ReliefRay& moved) const {
        moved = ray;
        if (!(depth > std::max(ray.origin.z, 0.f)))
            return 0;
        const double t = (double(depth) - double(ray.origin.z)) / double(ray.direction.z);
        glm::dvec2 at = glm::dvec2(ray.origin);
        if (wrap_ == HeightWrap::repeat)
            at -= glm::floor(at);
        at += t * glm::dvec2(ray.direction);
        if (wrap_ == HeightWrap::repeat)
            at -= glm::floor(at);
        moved.origin = glm::vec3(at, depth);
        moved.t_most = float(double(ray.t_most) - t);
        return t;
    }

    HeightWrap wrap_;
    DepthMaps maps_;
    DepthMapTable table_;
    std::unique_ptr<ReliefTracer> exact_;
};

void want_kind(const DepthMaps& maps, DepthMapKind kind, const char* method) {
    if (maps.kind() == kind)
        return;
    throw InputError(std::string(method) + ": these depth maps hold " +
                     (kind == DepthMapKind::first_hits
                          ? "lower bounds, not first hits; make them by trace_depth_maps"
                          : "first hits, not lower bounds; make them by bound_depth_maps"));
}

} // namespace

std::unique_ptr<ReliefTracer> make_depth_map_tracer(const HeightField& field, DepthMaps maps,
                                                    const DepthMapSearch& search) {
    want_kind(maps, DepthMapKind::first_hits, "depth-maps");
    if (search.steps < 1 || search.steps > kMostSteps || search.bisections < 0 || search.bisections > kMostBisections)
        throw InputError("depth-maps: " + std::to_string(search.steps) + " steps and " +
                         std::to_string(search.bisections) + " bisections; give 1 to " + std::to_string(kMostSteps) +
                         " and 0 to " + std::to_string(kMostBisections));
    return std::make_unique<DepthMapTracer>(field, std::move(maps), search);
}

std::unique_ptr<ReliefTracer> make_conservative_tracer(const HeightField& field, DepthMaps maps,
                                                       std::unique_ptr<ReliefTracer> exact) {
    want_kind(maps, DepthMapKind::lower_bounds, "conservative");
    return std::make_unique<ConservativeTracer>(field.wrap, std::move(maps), std::move(exact));
}

} // namespace kokage
