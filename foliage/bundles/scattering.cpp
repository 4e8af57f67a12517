#include "foliage/bundles/scattering.h"

#include "common/services/parallel.h"

#include <algorithm>
#include <hwy/highway.h>

namespace kokage::bundles {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Rgb4 = hn::FixedTag<float, 4>; // one side; every instruction set has vectors of four
using Vec = hn::Vec<Rgb4>;

/// Part of a row.
struct Part {
    const Side *begin, *end;
};

/// Adds the values at [from, to) behind begin.
HWY_INLINE Vec sum_links(const Part& part, std::size_t from, std::size_t to, const Rgb* values, Vec sum) {
    for (std::size_t i = from; i < to; ++i)
        sum = hn::Add(sum, hn::Load(Rgb4(), &values[part.begin[i]].r));
    return sum;
}

constexpr std::size_t kRowsAtOnce = 4;

/// Sums of the neighbours' values over parts of several rows, together as far as the shortest goes.
HWY_INLINE void sum_parts(const Part (&parts)[kRowsAtOnce], const Rgb* values, Vec (&sums)[kRowsAtOnce]) {
    const Rgb4 d;
    std::size_t length[kRowsAtOnce], shortest = ~std::size_t(0), longest = 0;
    for (std::size_t k = 0; k < kRowsAtOnce; ++k) {
        sums[k] = hn::Zero(d);
        length[k] = std::size_t(parts[k].end - parts[k].begin);
        shortest = std::min(shortest, length[k]);
        longest = std::max(longest, length[k]);
    }
    for (std::size_t i = 0; i < shortest; ++i)
        for (std::size_t k = 0; k < kRowsAtOnce; ++k)
            sums[k] = hn::Add(sums[k], hn::Load(d, &values[parts[k].begin[i]].r));
    if (HWY_UNLIKELY(longest > shortest))
        for (std::size_t k = 0; k < kRowsAtOnce; ++k)
            sums[k] = sum_links(parts[k], shortest, length[k], values, sums[k]);
}

/// Per side of a block.
struct BlockSums {
    HWY_ALIGN float values[2 * kSweepBlock][4];
    Vec of(std::size_t side) const { return hn::Load(Rgb4(), values[side]); }
};

/// Sums of one part of every row of patches [from, to), a block; part_of(place).
template <class PartOf>
HWY_INLINE void sum_rows(const Links& links, std::size_t from, std::size_t to, const Rgb* values, BlockSums& sums,
                         PartOf&& part_of) {
    const Rgb4 d;
    const std::uint16_t* side_at = links.side_at.data();
    std::size_t place = 2 * from;
    for (; place + kRowsAtOnce <= 2 * to; place += kRowsAtOnce) {
        Part parts[kRowsAtOnce];
        Vec sum[kRowsAtOnce];
        for (std::size_t k = 0; k < kRowsAtOnce; ++k)
            parts[k] = part_of(place + k);
        sum_parts(parts, values, sum);
        for (std::size_t k = 0; k < kRowsAtOnce; ++k)
            hn::Store(sum[k], d, sums.values[side_at[place + k]]);
    }
    for (; place < 2 * to; ++place) {
        const Part part = part_of(place);
        const auto length = std::size_t(part.end - part.begin);
        hn::Store(sum_links(part, 0, length, values, hn::Zero(d)), d, sums.values[side_at[place]]);
    }
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
            weights[side] = kPi * (1 - open[side]) / float(std::max(links.row_length(Side(side)), 1u));
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
    // Of large trees a quarter of the sides tells the products well enough: to read what they are made of takes as long
    // as a third of a sweep.
    const std::size_t stride = scene.patches.size() > 8 * kSweepBlock ? 4 : 1;
    struct Block {
        RadianceChange change;
        HistoryProducts products;
    };
    std::vector<Block> blocks((scene.patches.size() + kSweepBlock - 1) / kSweepBlock);
    parallel_blocks(scene.patches.size(), kSweepBlock, [&](std::size_t from, std::size_t to) {
        const Rgb4 d;
        ChangeSums change;
        const bool remember = history && !history->read[0].empty() && from / kSweepBlock % stride == 0;
        ProductSums products_of_block;
        BlockSums sums;
        const Side* neighbours = links.neighbours.data();
        sum_rows(links, from, to, radiance.data(), sums, [&](std::size_t place) {
            return Part{neighbours + links.begin[place], neighbours + links.begin[place + 1]};
        });
        for (std::size_t patch = from; patch < to; ++patch) {
            Vec irradiance[2];
            for (std::size_t k = 0; k < 2; ++k) {
                const std::size_t side = 2 * patch + k;
                irradiance[k] = hn::Mul(sums.of(side - 2 * from), hn::Set(d, weights[side]));
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
                    products_of_block.add(*history, side, hn::Sub(result, before));
                hn::Store(result, d, &scattered[side].r);
            }
        }
        blocks[from / kSweepBlock] = {change.change(), products_of_block.products()};
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
        BlockSums first, second;
        const Side* neighbours = links.neighbours.data();
        sum_rows(links, from, to, radiance.data(), first, [&](std::size_t place) {
            return Part{neighbours + links.begin[place], neighbours + links.middle[place]};
        });
        sum_rows(links, from, to, radiance.data(), second, [&](std::size_t place) {
            return Part{neighbours + links.middle[place], neighbours + links.begin[place + 1]};
        });
        for (std::size_t patch = from; patch < to; ++patch) {
            Vec difference[2]; // of irradiance
            for (std::size_t k = 0; k < 2; ++k) {
                const std::size_t side = 2 * patch + k;
                const std::size_t place = links.place(Side(side));
                const std::uint32_t begin = links.begin[place], middle = links.middle[place],
                                    end = links.begin[place + 1];
                const std::uint32_t lengths[2] = {middle - begin, end - middle};
                const Vec sums[2] = {first.of(side - 2 * from), second.of(side - 2 * from)};
                const bool both = lengths[0] > 0 && lengths[1] > 0;
                const float all = 1 / std::max(float(end - begin), 1.f);
                Vec irradiance[2];
                for (int h = 0; h < 2; ++h) {
                    const float closed = kPi * (1 - halves[h].open[side]);
                    irradiance[h] = both ? hn::Mul(sums[h], hn::Set(d, closed / float(lengths[h])))
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
