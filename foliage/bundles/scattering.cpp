#include "foliage/bundles/scattering.h"

#include "common/services/parallel.h"

#include <algorithm>
#include <hwy/highway.h>

namespace kokage::bundles {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Rgb4 = hn::FixedTag<float, 4>; // one side; every instruction set has vectors of four
using Vec = hn::Vec<Rgb4>;

struct Row {
    const Side *begin, *end;
};

HWY_INLINE Row row_of(const Links& links, std::size_t side) {
    return {links.neighbours.data() + links.begin[side], links.neighbours.data() + links.begin[side + 1]};
}

/// Sum of the neighbours' values over part of a row.
HWY_INLINE Vec sum_row(Row row, const Rgb* values) {
    const Rgb4 d;
    auto even = hn::Zero(d), odd = hn::Zero(d);
    const Side* i = row.begin;
    for (; i + 1 < row.end; i += 2) {
        even = hn::Add(even, hn::Load(d, &values[i[0]].r));
        odd = hn::Add(odd, hn::Load(d, &values[i[1]].r));
    }
    if (i < row.end)
        even = hn::Add(even, hn::Load(d, &values[*i].r));
    return hn::Add(even, odd);
}

struct PatchOptics {
    HWY_ALIGN float reflectance[4], transmittance[4]; ///< over pi
    explicit PatchOptics(const Optics& optics) {
        for (int c = 0; c < 3; ++c) {
            reflectance[c] = optics.reflectance[c] / kPi;
            transmittance[c] = optics.transmittance[c] / kPi;
        }
        reflectance[3] = transmittance[3] = 0;
    }
};

std::vector<PatchOptics> over_pi(const std::vector<Optics>& optics) {
    return {optics.begin(), optics.end()};
}

} // namespace

std::vector<float> link_weights(const Links& links, std::span<const float> open) {
    std::vector<float> weights(open.size());
    parallel_blocks(open.size(), 2 * kSweepBlock, [&](std::size_t from, std::size_t to) {
        for (std::size_t side = from; side < to; ++side)
            weights[side] = kPi * (1 - open[side]) / float(std::max(links.begin[side + 1] - links.begin[side], 1u));
    });
    return weights;
}

namespace {

glm::dvec3 channels(Vec value) {
    HWY_ALIGN float lanes[4];
    hn::Store(value, Rgb4(), lanes);
    return {lanes[0], lanes[1], lanes[2]};
}

/// Sums over a block of sides.
struct ChangeSums {
    Vec largest = hn::Zero(Rgb4()), largest_radiance = largest, total = largest, total_radiance = largest;
    void add(Vec before, Vec after) {
        const Vec step = hn::Abs(hn::Sub(after, before));
        largest = hn::Max(largest, step);
        largest_radiance = hn::Max(largest_radiance, after);
        total = hn::Add(total, step);
        total_radiance = hn::Add(total_radiance, after);
    }
    RadianceChange change() const {
        const glm::dvec3 most = channels(largest), brightest = channels(largest_radiance);
        return {std::max({most.x, most.y, most.z}), std::max({brightest.x, brightest.y, brightest.z, 0.0}),
                channels(total), channels(total_radiance)};
    }
};

struct ProductSums {
    Vec d1_d1 = hn::Zero(Rgb4()), d1_d2 = d1_d1, d2_d2 = d1_d1, d1_f0 = d1_d1, d2_f0 = d1_d1;
    void add(const SweepHistory& history, std::size_t side, Vec residual) {
        const auto residual_of = [&](int sweep) {
            return hn::Sub(hn::Load(Rgb4(), &history.made[sweep][side].r),
                           hn::Load(Rgb4(), &history.read[sweep][side].r));
        };
        const Vec last = residual_of(0), d1 = hn::Sub(residual, last);
        d1_d1 = hn::MulAdd(d1, d1, d1_d1);
        d1_f0 = hn::MulAdd(d1, residual, d1_f0);
        if (history.read[1].empty())
            return;
        const Vec d2 = hn::Sub(last, residual_of(1));
        d1_d2 = hn::MulAdd(d1, d2, d1_d2);
        d2_d2 = hn::MulAdd(d2, d2, d2_d2);
        d2_f0 = hn::MulAdd(d2, residual, d2_f0);
    }
    HistoryProducts products() const {
        return {channels(d1_d1), channels(d1_d2), channels(d2_d2), channels(d1_f0), channels(d2_f0)};
    }
};

} // namespace

RadianceChange scatter(const PatchScene& scene, const Links& links, const std::vector<Optics>& optics,
                       std::span<const float> weights, std::span<const Rgb> radiance, std::span<const Rgb> emitted,
                       std::span<Rgb> scattered, const SweepHistory* history, HistoryProducts* products) {
    const std::vector<PatchOptics> of_patches = over_pi(optics);
    const bool remember = history && !history->read[0].empty();
    struct Block {
        RadianceChange change;
        HistoryProducts products;
    };
    std::vector<Block> blocks((scene.patches.size() + kSweepBlock - 1) / kSweepBlock);
    parallel_blocks(scene.patches.size(), kSweepBlock, [&](std::size_t from, std::size_t to) {
        const Rgb4 d;
        ChangeSums change;
        ProductSums sums;
        for (std::size_t patch = from; patch < to; ++patch) {
            Vec irradiance[2];
            for (std::size_t k = 0; k < 2; ++k) {
                const std::size_t side = 2 * patch + k;
                irradiance[k] = hn::Mul(sum_row(row_of(links, side), radiance.data()), hn::Set(d, weights[side]));
            }
            const PatchOptics& optic = of_patches[scene.patches[patch].optics];
            const auto r = hn::Load(d, optic.reflectance), t = hn::Load(d, optic.transmittance);
            for (std::size_t k = 0; k < 2; ++k) {
                const std::size_t side = 2 * patch + k;
                auto result = hn::MulAdd(r, irradiance[k], hn::Mul(t, irradiance[1 - k]));
                if (!emitted.empty())
                    result = hn::Add(result, hn::Load(d, &emitted[side].r));
                const auto before = hn::Load(d, &radiance[side].r);
                change.add(before, result);
                if (remember)
                    sums.add(*history, side, hn::Sub(result, before));
                hn::Store(result, d, &scattered[side].r);
            }
        }
        blocks[from / kSweepBlock] = {change.change(), sums.products()};
    });
    RadianceChange all;
    HistoryProducts all_products;
    for (const Block& block : blocks) {
        all.largest = std::max(all.largest, block.change.largest);
        all.largest_radiance = std::max(all.largest_radiance, block.change.largest_radiance);
        all.total += block.change.total;
        all.total_radiance += block.change.total_radiance;
        all_products.d1_d1 += block.products.d1_d1;
        all_products.d1_d2 += block.products.d1_d2;
        all_products.d2_d2 += block.products.d2_d2;
        all_products.d1_f0 += block.products.d1_f0;
        all_products.d2_f0 += block.products.d2_f0;
    }
    if (products)
        *products = all_products;
    return all;
}

void scatter_outside(const PatchScene& scene, const std::vector<Optics>& optics, std::span<const Rgb> irradiance,
                     std::span<Rgb> radiance) {
    const std::vector<PatchOptics> of_patches = over_pi(optics);
    parallel_blocks(scene.patches.size(), kSweepBlock, [&](std::size_t from, std::size_t to) {
        const Rgb4 d;
        for (std::size_t patch = from; patch < to; ++patch) {
            const PatchOptics& optic = of_patches[scene.patches[patch].optics];
            const auto r = hn::Load(d, optic.reflectance), t = hn::Load(d, optic.transmittance);
            const auto front = hn::Load(d, &irradiance[2 * patch].r), back = hn::Load(d, &irradiance[2 * patch + 1].r);
            hn::Store(hn::MulAdd(r, front, hn::Mul(t, back)), d, &radiance[2 * patch].r);
            hn::Store(hn::MulAdd(r, back, hn::Mul(t, front)), d, &radiance[2 * patch + 1].r);
        }
    });
}

void scatter_halves(const PatchScene& scene, const Links& links, const std::vector<Optics>& optics,
                    std::span<const Rgb> radiance, const HalfLight (&halves)[2], std::span<Rgb> half_difference,
                    std::span<Rgb> mean_irradiance, std::size_t stride) {
    const std::vector<PatchOptics> of_patches = over_pi(optics);
    parallel_blocks(scene.patches.size(), kSweepBlock, [&](std::size_t from, std::size_t to) {
        if (from / kSweepBlock % stride != 0)
            return;
        const Rgb4 d;
        const auto half = hn::Set(d, 0.5f);
        for (std::size_t patch = from; patch < to; ++patch) {
            Vec difference[2]; // of irradiance
            for (std::size_t k = 0; k < 2; ++k) {
                const std::size_t side = 2 * patch + k;
                const Side *begin = links.neighbours.data() + links.begin[side],
                           *middle = links.neighbours.data() + links.middle[side],
                           *end = links.neighbours.data() + links.begin[side + 1];
                const Row rows[2] = {{begin, middle}, {middle, end}};
                const Vec sums[2] = {sum_row(rows[0], radiance.data()), sum_row(rows[1], radiance.data())};
                const bool both = begin < middle && middle < end;
                const float all = 1 / std::max(float(end - begin), 1.f);
                Vec irradiance[2];
                for (int h = 0; h < 2; ++h) {
                    const float closed = kPi * (1 - halves[h].open[side]);
                    irradiance[h] = both ? hn::Mul(sums[h], hn::Set(d, closed / float(rows[h].end - rows[h].begin)))
                                         : hn::Mul(hn::Add(sums[0], sums[1]), hn::Set(d, closed * all));
                    if (!halves[h].irradiance.empty())
                        irradiance[h] = hn::Add(irradiance[h], hn::Load(d, &halves[h].irradiance[side].r));
                }
                difference[k] = hn::Mul(half, hn::Sub(irradiance[0], irradiance[1]));
                hn::Store(hn::Mul(half, hn::Add(irradiance[0], irradiance[1])), d, &mean_irradiance[side].r);
            }
            const PatchOptics& optic = of_patches[scene.patches[patch].optics];
            const auto r = hn::Load(d, optic.reflectance), t = hn::Load(d, optic.transmittance);
            for (std::size_t k = 0; k < 2; ++k)
                hn::Store(hn::MulAdd(r, difference[k], hn::Mul(t, difference[1 - k])), d,
                          &half_difference[2 * patch + k].r);
        }
    });
}

} // namespace kokage::bundles
