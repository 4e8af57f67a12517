#include "foliage/side_paths.h"
#include "common/services/parallel.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

constexpr std::size_t kBlock = 16; ///< patches a block

void add(SideSums& sums, int half, const PathTracer::IrradianceSample& sample) {
    sums.half[half] += glm::dvec3(sample.total);
    sums.from_lights += glm::dvec3(sample.direct_from_lights);
    sums.from_patches += glm::dvec3(sample.from_patches);
    if (sample.first_met == PathTracer::Met::sky) {
        sums.sees_sky += double(sample.path_weight);
        sums.open_direction += glm::dvec3(sample.path_direction) * double(sample.path_weight);
    } else if (sample.first_met == PathTracer::Met::ground) {
        sums.sees_ground += double(sample.path_weight);
    }
    ++sums.count[half];
}

} // namespace

SidePaths::SidePaths(const PatchScene& scene, const PatchPoints& points, std::uint64_t seed, bool with_bark)
    : scene_(scene), points_(points), seed_(seed), share_(scene.patches.size(), 0.f), sides_(2 * scene.patches.size()) {
    std::vector<double> leaf_area(scene.leaf_count, 0.0);
    for (std::size_t p = 0; p < scene.patches.size(); ++p)
        if (scene.patches[p].kind == PatchKind::leaf)
            leaf_area[scene.patches[p].leaf] += points.areas()[p];
    for (std::size_t p = 0; p < scene.patches.size(); ++p) {
        if (!(points.areas()[p] > 0))
            continue;
        if (scene.patches[p].kind == PatchKind::leaf)
            share_[p] = float(points.areas()[p] / leaf_area[scene.patches[p].leaf]);
        else if (with_bark)
            share_[p] = 1;
    }
}

SidePaths::SidePaths(const PatchScene& scene, const PatchPoints& points, std::uint64_t seed,
                     const std::vector<bool>& leaves)
    : SidePaths(scene, points, seed, false) {
    for (std::size_t p = 0; p < scene.patches.size(); ++p)
        if (scene.patches[p].kind == PatchKind::leaf && !leaves[scene.patches[p].leaf])
            share_[p] = 0;
}

std::uint32_t SidePaths::paths_of(std::size_t patch, std::uint32_t half_paths) const {
    if (!(share_[patch] > 0) || half_paths == 0)
        return 0;
    return std::max(1u, std::uint32_t(std::ceil(double(share_[patch]) * double(half_paths) - 1e-6)));
}

void SidePaths::extend_to(std::uint32_t paths, const PathTracer& tracer, Progress& progress) {
    const std::uint32_t half_paths = paths / 2 + paths % 2;
    parallel_blocks(scene_.patches.size(), kBlock, [&](std::size_t begin, std::size_t end) {
        progress.throw_if_stopped();
        for (std::size_t p = begin; p < end; ++p)
            for (std::size_t s = 2 * p; s < 2 * p + 2; ++s)
                for (int half = 0; half < 2; ++half)
                    for (std::uint32_t i = paths_of(p, half_paths_); i < paths_of(p, half_paths); ++i) {
                        if (i % 1024 == 1023) // a side may have very many
                            progress.throw_if_stopped();
                        PathNumbers numbers(hash64(seed_ ^ hash64(2 * s + std::size_t(half))), i);
                        PatchPoint point;
                        if (points_.sample(std::uint32_t(p), numbers, point))
                            add(sides_[s], half,
                                tracer.sample_irradiance(point.position, s % 2 == 0 ? point.normal : -point.normal,
                                                         numbers));
                    }
        progress.advance(end - begin);
    });
    half_paths_ = std::max(half_paths_, half_paths);
}

std::uint64_t SidePaths::paths_traced() const {
    std::uint64_t sum = 0;
    for (const SideSums& side : sides_)
        sum += std::uint64_t(side.count[0]) + side.count[1];
    return sum;
}

SideRadiance SidePaths::radiance(const std::vector<Optics>& optics, int half) const {
    SideRadiance result;
    for (std::size_t p = 0; p < scene_.patches.size(); ++p) {
        const auto arriving = [&](bool is_front) {
            return half < 0 ? side(p, is_front).irradiance() : side(p, is_front).half_irradiance(half);
        };
        const glm::dvec3 front = arriving(true), back = arriving(false);
        const glm::dvec3 rho(optics[scene_.patches[p].optics].reflectance),
            tau(optics[scene_.patches[p].optics].transmittance);
        result.front.emplace_back((rho * front + tau * back) / kPiDouble);
        result.back.emplace_back((rho * back + tau * front) / kPiDouble);
    }
    return result;
}

double half_sample_error(const std::vector<glm::vec3>& first, const std::vector<glm::vec3>& second) {
    glm::dvec3 mean(0);
    for (std::size_t s = 0; s < first.size(); ++s)
        mean += 0.5 * (glm::dvec3(first[s]) + glm::dvec3(second[s]));
    mean /= std::max<double>(1, double(first.size()));
    double sum = 0;
    for (std::size_t s = 0; s < first.size(); ++s)
        for (std::size_t c = 0; c < 3; ++c) {
            const double value = 0.5 * (double(first[s][c]) + double(second[s][c]));
            const double scale = std::max(value, 0.05 * mean[c]);
            if (scale > 0)
                sum += 0.5 * std::abs(double(first[s][c]) - double(second[s][c])) / scale;
        }
    return first.empty() ? 0 : sum / (3 * double(first.size()));
}

} // namespace kokage
