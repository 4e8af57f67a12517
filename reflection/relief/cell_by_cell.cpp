#include "reflection/relief/cell_by_cell.h"
#include "reflection/relief/cell_walk.h"

namespace kokage {

TrueReliefHit true_relief_hit(const HeightField& field, const ReliefRay& ray) {
    const TexelGrid grid{field.width, field.height, field.wrap};
    return walk_to_hit(grid, texel_ray(grid, ray), 0,
                       [&](long long i, long long j) { return bilinear_cell(field, i, j); });
}

double greatest_depth_below(const HeightField& field, const ReliefRay& ray, double t0, double t1) {
    const TexelRay r = texel_ray({field.width, field.height, field.wrap}, ray);
    double greatest = -kNever;
    t0 = std::max(t0 - r.t_base, 0.);
    t1 = std::min(t1 - r.t_base, r.length);
    if (!(t0 <= t1))
        return greatest;
    walk_cells(r, t0, t1, [&](long long i, long long j, double t_in, double t_out) {
        const CellQuadratic q = ray_over_cell(r, bilinear_cell(field, i, j), t_in, double(i), double(j));
        const double length = t_out - t_in;
        greatest = std::max({greatest, q.at(0), q.at(length)});
        const double top = q.a < 0 ? -q.b / (2 * q.a) : -1;
        if (top > 0 && top < length)
            greatest = std::max(greatest, q.at(top));
        return false;
    });
    return greatest;
}

namespace {

class CellByCellTracer final : public ReliefTracer {
  public:
    explicit CellByCellTracer(const HeightField& field) : field_(field) {}

    void trace(std::span<const ReliefRay> rays, std::span<ReliefHit> hits) const override {
        for (std::size_t k = 0; k < rays.size(); ++k) {
            const TrueReliefHit hit = true_relief_hit(field_, rays[k]);
            hits[k] = {float(hit.t), glm::vec2(hit.coordinate), float(hit.depth), glm::vec2(hit.slope), hit.reads};
            if (field_.wrap == HeightWrap::repeat) // 1 - 1e-12 is 1 as a float
                hits[k].coordinate -= glm::floor(hits[k].coordinate);
        }
    }
    void occluded(std::span<const ReliefRay> rays, std::span<std::uint8_t> hidden,
                  std::span<std::uint32_t> reads) const override {
        for (std::size_t k = 0; k < rays.size(); ++k) {
            const TrueReliefHit hit = true_relief_hit(field_, rays[k]);
            hidden[k] = hit.found();
            if (!reads.empty())
                reads[k] = hit.reads;
        }
    }
    std::size_t bytes() const override { return field_.bytes(); }

  private:
    const HeightField& field_;
};

} // namespace

std::unique_ptr<ReliefTracer> make_cell_by_cell_tracer(const HeightField& field) {
    return std::make_unique<CellByCellTracer>(field);
}

} // namespace kokage
