#include "foliage/bundles/anderson.h"

#include "common/services/parallel.h"

#include <Eigen/Dense>
#include <hwy/highway.h>
#include <utility>

namespace kokage::bundles {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Rgb4 = hn::FixedTag<float, 4>;
constexpr std::size_t kBlock = 1 << 17; // waking a thread for less costs more than it saves

/// The weights that make |f0 - w1 d1 - w2 d2| least, per channel. Steps that no longer differ get no weight instead of
/// a huge one.
std::array<glm::vec3, 2> least_squares(const HistoryProducts& products) {
    std::array<glm::vec3, 2> weights{glm::vec3(0.f), glm::vec3(0.f)};
    for (glm::length_t c = 0; c < 3; ++c) {
        Eigen::Matrix2d gram;
        gram << products.d1_d1[c], products.d1_d2[c], products.d1_d2[c], products.d2_d2[c];
        const Eigen::Vector2d right(products.d1_f0[c], products.d2_f0[c]);
        const Eigen::Vector2d solution = gram.completeOrthogonalDecomposition().solve(right);
        for (int i = 0; i < 2 && solution.allFinite(); ++i)
            weights[std::size_t(i)][c] = float(solution[i]);
    }
    return weights;
}

/// sum = a wa + b wb + c wc; wherever b or c is empty, it has no weight. False if much of it is negative.
bool combine(const std::vector<Rgb>& a, const std::vector<Rgb>& b, const std::vector<Rgb>& c,
             const std::array<glm::vec3, 3>& weights, std::vector<Rgb>& sum) {
    HWY_ALIGN float w[3][4];
    for (std::size_t i = 0; i < 3; ++i)
        for (glm::length_t k = 0; k < 4; ++k)
            w[i][k] = k < 3 ? weights[i][k] : 0.f;
    struct Signs {
        glm::dvec3 positive{0.0}, negative{0.0};
    };
    std::vector<Signs> parts((a.size() + kBlock - 1) / kBlock);
    parallel_blocks(a.size(), kBlock, [&](std::size_t from, std::size_t to) {
        const Rgb4 d;
        const auto wa = hn::Load(d, w[0]), wb = hn::Load(d, w[1]), wc = hn::Load(d, w[2]), zero = hn::Zero(d);
        auto positive = zero, negative = zero;
        for (std::size_t i = from; i < to; ++i) {
            auto value = hn::Mul(wa, hn::Load(d, &a[i].r));
            if (!b.empty())
                value = hn::MulAdd(wb, hn::Load(d, &b[i].r), value);
            if (!c.empty())
                value = hn::MulAdd(wc, hn::Load(d, &c[i].r), value);
            hn::Store(value, d, &sum[i].r);
            positive = hn::Add(positive, hn::Max(value, zero));
            negative = hn::Sub(negative, hn::Min(value, zero));
        }
        HWY_ALIGN float lanes[2][4];
        hn::Store(positive, d, lanes[0]);
        hn::Store(negative, d, lanes[1]);
        parts[from / kBlock] = {{lanes[0][0], lanes[0][1], lanes[0][2]}, {lanes[1][0], lanes[1][1], lanes[1][2]}};
    });
    Signs all;
    for (const Signs& part : parts) {
        all.positive += part.positive;
        all.negative += part.negative;
    }
    return !glm::any(glm::greaterThan(all.negative, 0.1 * all.positive));
}

} // namespace

SweepHistory AndersonAcceleration::history() const {
    return {{sweeps_[0].read, sweeps_[1].read}, {sweeps_[0].made, sweeps_[1].made}};
}

void AndersonAcceleration::advance(std::vector<Rgb>& x, std::vector<Rgb>& image, const HistoryProducts& products) {
    std::vector<Rgb> next = std::move(sweeps_[1].read); // is read no more
    next.resize(x.size());
    bool plausible = false;
    if (!sweeps_[0].made.empty()) {
        const auto [w1, w2] = least_squares(products);
        plausible = combine(image, sweeps_[0].made, sweeps_[1].made, {1.f - w1, w1 - w2, w2}, next);
    }
    if (!plausible)
        next = image;
    std::vector<Rgb> room = std::move(sweeps_[1].made);
    room.resize(x.size());
    sweeps_[1] = std::move(sweeps_[0]);
    sweeps_[0] = {std::exchange(x, std::move(next)), std::exchange(image, std::move(room))};
}

} // namespace kokage::bundles
