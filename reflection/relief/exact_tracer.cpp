#include "reflection/relief/exact_tracer.h"
#include "reflection/relief/bound_planes.h"
#include "reflection/relief/cell_walk.h"
#include "reflection/relief/exact_stream.h"

#include <atomic>
#include <utility>

namespace kokage {
namespace {

/// Rays that vector code takes at a time: their numbers fit in 32 bits, and so do their results in a cache.
constexpr std::size_t kBlock = 1 << 16;

class BoundPlanesTracer final : public ExactTracer {
  public:
    explicit BoundPlanesTracer(BoundPlanes bounds) : bounds_(std::move(bounds)) {}

    void trace(std::span<const ReliefRay> rays, std::span<ReliefHit> hits) const override {
        std::vector<DoubtfulRay> doubtful;
        for (std::size_t first = 0; first < rays.size(); first += kBlock) {
            const auto block = rays.subspan(first, std::min(kBlock, rays.size() - first));
            ReliefHit* to = hits.data() + first;
            doubtful.clear();
            trace_stream(bounds_, block, to, doubtful);
            for (const DoubtfulRay& d : doubtful) {
                const TrueReliefHit hit = certain_hit(block[d.ray], d.t);
                to[d.ray] = {float(hit.t), glm::vec2(hit.coordinate), float(hit.depth), glm::vec2(hit.slope),
                             to[d.ray].reads + hit.reads};
                if (bounds_.wrap == HeightWrap::repeat) // 1 - 1e-12 is 1 as a float
                    to[d.ray].coordinate -= glm::floor(to[d.ray].coordinate);
            }
            doubtful_ += doubtful.size();
        }
    }

    void occluded(std::span<const ReliefRay> rays, std::span<std::uint8_t> hidden,
                  std::span<std::uint32_t> reads) const override {
        std::vector<DoubtfulRay> doubtful;
        for (std::size_t first = 0; first < rays.size(); first += kBlock) {
            const auto block = rays.subspan(first, std::min(kBlock, rays.size() - first));
            std::uint32_t* counts = reads.empty() ? nullptr : reads.data() + first;
            doubtful.clear();
            occlude_stream(bounds_, block, hidden.data() + first, counts, doubtful);
            for (const DoubtfulRay& d : doubtful) {
                const TrueReliefHit hit = certain_hit(block[d.ray], d.t);
                hidden[first + d.ray] = hit.found();
                if (counts)
                    counts[d.ray] += hit.reads;
            }
            doubtful_ += doubtful.size();
        }
    }

    std::size_t bytes() const override { return bounds_.bytes(); }
    void store(const std::filesystem::path& path) const override { store_bound_planes(bounds_, path); }
    std::size_t doubtful_rays() const override { return doubtful_; }

  private:
    BilinearCell cell(long long i, long long j) const {
        const auto index = [&](long long at, int count) { // of the cell's first corner
            return std::size_t(texel_index(at - bounds_.first_texel(), count, bounds_.wrap));
        };
        const std::size_t stride = std::size_t(bounds_.stride());
        const float* corner = bounds_.depths.data() + index(j, bounds_.rows) * stride + index(i, bounds_.columns);
        const double d00 = corner[0], d10 = corner[1], d01 = corner[stride], d11 = corner[stride + 1];
        return {d00, d10 - d00, d01 - d00, d11 - d10 - d01 + d00};
    }

    /// Double precision from time t after the ray's entry on.
    TrueReliefHit certain_hit(const ReliefRay& ray, double t) const {
        const TexelGrid grid{bounds_.width, bounds_.height, bounds_.wrap};
        const TexelRay r = texel_ray(grid, ray);
        // Single precision errs by less than a hundredth of a texel.
        const double speed = std::max(std::abs(r.direction.x), std::abs(r.direction.y));
        return walk_to_hit(grid, r, t > 0 && speed > 0 ? std::max(0., t - 0.01 / speed) : 0,
                           [&](long long i, long long j) { return cell(i, j); });
    }

    BoundPlanes bounds_;
    mutable std::atomic<std::size_t> doubtful_ = 0;
};

} // namespace

std::unique_ptr<ExactTracer> make_exact_tracer(const HeightField& field) {
    return std::make_unique<BoundPlanesTracer>(make_bound_planes(field));
}

std::unique_ptr<ExactTracer> load_exact_tracer(const HeightField& field, const std::filesystem::path& path) {
    return std::make_unique<BoundPlanesTracer>(load_bound_planes(field, path));
}

} // namespace kokage
