#include "foliage/bundles/anderson.h"

#include "common/services/parallel.h"

#include <Eigen/Dense>
#include <cmath>

namespace kokage::bundles {
namespace {

constexpr std::size_t kBlock = 8192;

std::vector<Rgb> difference(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
    std::vector<Rgb> result(a.size());
    parallel_blocks(a.size(), kBlock, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i)
            result[i] = {a[i].r - b[i].r, a[i].g - b[i].g, a[i].b - b[i].b, 0};
    });
    return result;
}

/// Per channel, added in block order.
glm::dvec3 inner_product(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
    std::vector<glm::dvec3> parts((a.size() + kBlock - 1) / kBlock);
    parallel_blocks(a.size(), kBlock, [&](std::size_t from, std::size_t to) {
        double sum[4] = {0, 0, 0, 0};
        for (std::size_t i = from; i < to; ++i) {
            sum[0] += double(a[i].r) * b[i].r;
            sum[1] += double(a[i].g) * b[i].g;
            sum[2] += double(a[i].b) * b[i].b;
        }
        parts[from / kBlock] = {sum[0], sum[1], sum[2]};
    });
    glm::dvec3 total(0.0);
    for (const glm::dvec3& part : parts)
        total += part;
    return total;
}

} // namespace

std::vector<Rgb> AndersonAcceleration::next(const std::vector<Rgb>& x, const std::vector<Rgb>& image) {
    std::vector<Rgb> residual = difference(image, x);
    if (!last_residual_.empty()) {
        steps_.push_back({difference(residual, last_residual_), difference(image, last_image_), {}});
        if (int(steps_.size()) > depth_)
            steps_.pop_front();
        Step& newest = steps_.back();
        for (auto step = steps_.rbegin(); step != steps_.rend(); ++step)
            newest.products.push_back(inner_product(newest.residual_change, step->residual_change));
    }
    const auto depth = Eigen::Index(steps_.size());
    std::vector<glm::vec3> weights(steps_.size(), glm::vec3(0.f));
    Eigen::MatrixXd gram[3];
    Eigen::VectorXd right[3];
    for (int c = 0; c < 3; ++c) {
        gram[c].resize(depth, depth);
        right[c].resize(depth);
    }
    for (Eigen::Index i = 0; i < depth; ++i) {
        const glm::dvec3 projection = inner_product(steps_[std::size_t(i)].residual_change, residual);
        for (int c = 0; c < 3; ++c)
            right[c][i] = projection[c];
        for (Eigen::Index j = 0; j <= i; ++j)
            for (int c = 0; c < 3; ++c)
                gram[c](i, j) = gram[c](j, i) = steps_[std::size_t(i)].products[std::size_t(i - j)][c];
    }
    for (int c = 0; c < 3 && depth > 0; ++c) {
        // The least-norm solution: steps that no longer differ get no weight instead of a huge one.
        const Eigen::VectorXd solution = gram[c].completeOrthogonalDecomposition().solve(right[c]);
        for (Eigen::Index i = 0; i < depth; ++i)
            weights[std::size_t(i)][c] = std::isfinite(solution[i]) ? float(solution[i]) : 0.f;
    }
    std::vector<Rgb> next = image;
    parallel_blocks(next.size(), kBlock, [&](std::size_t from, std::size_t to) {
        for (std::size_t k = 0; k < steps_.size(); ++k)
            for (std::size_t i = from; i < to; ++i) {
                const Rgb& change = steps_[k].image_change[i];
                next[i].r -= weights[k].x * change.r;
                next[i].g -= weights[k].y * change.g;
                next[i].b -= weights[k].z * change.b;
            }
    });
    last_residual_ = std::move(residual);
    last_image_ = image;
    return next;
}

} // namespace kokage::bundles
