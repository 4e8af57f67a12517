#include "foliage/bundles/error_by_paths.h"

#include "common/services/random.h"
#include "foliage/accuracy.h"
#include "foliage/side_paths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace kokage::bundles {
namespace {

constexpr std::uint32_t kLeaves = 192;
constexpr std::uint32_t kFirstPaths = 32, kMostPathsASide = 1 << 16; // of a side
constexpr std::uint64_t kMostPaths = 50000, kMostPathsInDoubt = 200000;
constexpr double kUncertainty = 0.15, kDoubt = 0.21;

std::vector<glm::vec3> chosen_sides(const std::vector<glm::vec3>& sides, const std::vector<std::uint32_t>& leaves) {
    std::vector<glm::vec3> chosen;
    for (std::uint32_t leaf : leaves) {
        chosen.push_back(sides[2 * std::size_t(leaf)]);
        chosen.push_back(sides[2 * std::size_t(leaf) + 1]);
    }
    return chosen;
}

glm::dvec3 mean_of(const std::vector<glm::vec3>& sides) {
    glm::dvec3 sum(0.0);
    for (const glm::vec3& side : sides)
        sum += glm::dvec3(side);
    return sides.empty() ? sum : sum / double(sides.size());
}

/// Classes of a value over its channel's mean, an octave each.
constexpr int kClasses = 7;
int class_of(double relative) {
    return relative > 0 ? std::clamp(int(std::floor(std::log2(relative))) + 5, 0, kClasses - 1) : 0;
}

/// Sums of relative differences within a class.
struct ClassSums {
    double count = 0, from_paths = 0, noise = 0;
    ClassSums& operator-=(const ClassSums& other) {
        count -= other.count;
        from_paths -= other.from_paths;
        noise -= other.noise;
        return *this;
    }
};
using Sums = std::array<ClassSums, kClasses>;

/// All sides' values: share of each class, and the error that half differences show in it.
struct Shown {
    std::array<double, kClasses> share{}, error{};
};

Shown shown_by_halves(const JudgedSides& judged, const glm::dvec3& mean) {
    Shown shown;
    double count = 0;
    for (std::size_t s = 0; s < judged.radiance.size(); ++s)
        for (std::size_t c = 0; c < 3; ++c) {
            if (!(mean[c] > 0))
                continue;
            const double own = judged.radiance[s][c];
            const int k = class_of(own / mean[c]);
            shown.error[k] += std::abs(double(judged.half_differences[s][c])) / std::max(own, 0.05 * mean[c]);
            ++shown.share[k];
            ++count;
        }
    for (int k = 0; k < kClasses; ++k) {
        shown.error[k] /= std::max(shown.share[k], 1.0);
        shown.share[k] /= std::max(count, 1.0);
    }
    return shown;
}

/// The squared error that paths tell of a class, and how well they know it.
struct Told {
    double square = 0;
    double noise = 0; ///< variance of `square` that the paths' noise makes
    double all = 0;   ///< with that of having few leaves, if the squared error is about `expected`
    double skew = 0;  ///< by how much `square` may be too large, in all classes alike
};

/// Variances are those of means of independent values that spread about as widely as they are large.
Told told_by_paths(const ClassSums& sum, double expected) {
    // Few paths of which few are bright are skewed: the mean of |noise| is then larger than halves show, by up to this
    // share of its square.
    constexpr double kSkew = 0.3;
    const double all = sum.from_paths / sum.count, noise = sum.noise / sum.count;
    const double noise2 = noise * noise, all2 = expected + noise2, independent = sum.count / 3;
    Told told;
    told.square = all * all - noise2;
    told.skew = kSkew * noise2;
    told.noise = 8 / independent * noise2 * noise2 + told.skew * told.skew + 1e-30;
    told.all = 4 / independent * (all2 * all2 + noise2 * noise2) + told.skew * told.skew + 1e-30;
    return told;
}

/// The error over all classes, and the part of its standard deviation that noise makes.
struct Together {
    double error = 0, deviation = 0;
};

/// Error over what halves show, squared: as all classes say, each weighted by how well it knows.
struct Ratio {
    double square = 1, skew = 0;
};

Ratio common_ratio(const Sums& sums, const Shown& shown) {
    Ratio ratio;
    for (int pass = 0; pass < 3; ++pass) { // weights need the ratio
        double products = 0, squares = 0, skew = 0;
        for (int k = 0; k < kClasses; ++k)
            if (sums[k].count > 0 && shown.error[k] > 0) {
                const double expected = shown.error[k] * shown.error[k];
                const Told told = told_by_paths(sums[k], ratio.square * expected);
                products += expected * told.square / told.all;
                squares += expected * expected / told.all;
                skew += expected * told.skew / told.all;
            }
        if (!(squares > 0))
            return {0, 0};
        ratio = {std::max(products / squares, 0.0), skew / squares};
    }
    return ratio;
}

Together put_together(const Sums& sums, const Shown& shown) {
    const Ratio ratio = common_ratio(sums, shown);
    // A class is believed itself as far as noise lets it know, and else is expected to follow that ratio.
    constexpr double kLooseness = 0.8;
    Together all;
    double variance = 0;
    for (int k = 0; k < kClasses; ++k) {
        const double expected = ratio.square * shown.error[k] * shown.error[k];
        double square = expected, square_variance = std::pow(kLooseness * expected, 2);
        if (sums[k].count > 0) {
            const Told told = told_by_paths(sums[k], expected);
            const double trust = shown.error[k] > 0 ? square_variance / (square_variance + told.noise + 1e-30) : 1.0;
            square += trust * (told.square - expected);
            square_variance = trust * told.noise;
        }
        const double error = std::sqrt(std::max(square, 0.0));
        all.error += shown.share[k] * error;
        if (error > 0)
            variance += std::pow(shown.share[k] * 0.5 * std::sqrt(square_variance) / error, 2);
    }
    // Half of what skew may do, as a share of the squared error, and half of that again for the error itself.
    const double skewed = ratio.square > 0 ? 0.25 * ratio.skew / ratio.square * all.error : 0.0;
    all.deviation = std::sqrt(variance + skewed * skewed);
    return all;
}

constexpr std::size_t kGroups = 12;

/// Sums of all leaves, and of groups of them.
struct GroupedSums {
    Sums all{};
    std::array<Sums, kGroups> groups{};
};

/// `trust`: in the paths, of each class, as the reference that errors are relative to. Where own values are wrong by
/// much, it is the paths' that count; where paths are noisy, they would make errors of nothing.
GroupedSums add_up(const JudgedSides& judged, const TracedSides& traced, const glm::dvec3& mean,
                   const std::array<double, kClasses>& trust) {
    GroupedSums sums;
    for (std::size_t s = 0; s < traced.first.size(); ++s) {
        const std::size_t leaf = s / 2, side = 2 * std::size_t(traced.leaves[leaf]) + s % 2;
        for (std::size_t c = 0; c < 3; ++c) {
            if (!(mean[c] > 0))
                continue;
            const double first = traced.first[s][c], second = traced.second[s][c], own = judged.radiance[side][c];
            const int k = class_of(own / mean[c]);
            const double off = 0.5 * (first + second) - own, scale = std::max(own + trust[k] * off, 0.05 * mean[c]);
            for (Sums* part : {&sums.all, &sums.groups[leaf % kGroups]}) {
                ClassSums& sum = (*part)[k];
                ++sum.count;
                sum.from_paths += std::abs(off) / scale;
                sum.noise += 0.5 * std::abs(first - second) / scale;
            }
        }
    }
    return sums;
}

} // namespace

MeasuredError error_beneath_noise(const JudgedSides& judged, const TracedSides& traced) {
    const glm::dvec3 mean = mean_of(judged.radiance);
    const Shown shown = shown_by_halves(judged, mean);
    std::array<double, kClasses> trust{};
    GroupedSums sums;
    for (int pass = 0; pass < 2; ++pass) {
        sums = add_up(judged, traced, mean, trust);
        for (int k = 0; k < kClasses; ++k)
            if (const ClassSums& sum = sums.all[k]; sum.from_paths > 0)
                trust[k] = std::max(1 - std::pow(sum.noise / sum.from_paths, 2), 0.0);
    }
    const Together together = put_together(sums.all, shown);
    // The jackknife over groups of leaves sees what the formula does not.
    double scatter = 0;
    for (const Sums& group : sums.groups) {
        Sums rest = sums.all;
        for (int k = 0; k < kClasses; ++k)
            rest[k] -= group[k];
        const double difference = put_together(rest, shown).error - together.error;
        scatter += difference * difference * double(kGroups - 1) / double(kGroups);
    }
    MeasuredError result;
    result.error = together.error;
    const double deviation = std::hypot(together.deviation, std::sqrt(scatter));
    result.uncertainty = together.error > 0 ? std::min(deviation / together.error, 1.0) : 1.0;
    return result;
}

std::vector<std::uint32_t> sample_leaves(const std::vector<double>& leaf_areas, std::uint32_t count,
                                         std::uint64_t seed) {
    std::vector<std::uint32_t> order(leaf_areas.size());
    std::iota(order.begin(), order.end(), 0);
    if (order.size() <= count)
        return order;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return leaf_areas[a] < leaf_areas[b]; });
    // One leaf out of each of `count` equal parts.
    Random random(seed, 0x5a3d);
    const double part = double(order.size()) / count;
    std::vector<std::uint32_t> chosen;
    for (std::uint32_t i = 0; i < count; ++i)
        chosen.push_back(order[std::min(std::size_t((i + random.uniform_double()) * part), order.size() - 1)]);
    std::sort(chosen.begin(), chosen.end());
    chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
    return chosen;
}

ErrorByPaths::ErrorByPaths(const PatchScene& scene)
    : scene_(scene), queries_(scene), points_(scene), leaf_areas_(scene.leaf_count, 0.0) {
    for (std::size_t p = 0; p < scene.patches.size(); ++p)
        if (scene.patches[p].kind == PatchKind::leaf)
            leaf_areas_[scene.patches[p].leaf] += points_.areas()[p];
}

MeasuredError ErrorByPaths::measure(const JudgedSides& judged, const Environment& environment,
                                    const std::vector<Optics>& optics, int max_bounces, std::uint64_t seed,
                                    TracedSides& traced, Progress& progress) {
    if (scene_.leaf_count == 0)
        return {};
    const std::vector<std::uint32_t> leaves = sample_leaves(leaf_areas_, kLeaves, seed);
    std::vector<bool> chosen(scene_.leaf_count, false);
    for (std::uint32_t leaf : leaves)
        chosen[leaf] = true;
    PathTracerOptions options;
    options.max_bounces = max_bounces;
    options.optics = optics;
    const PathTracer tracer(queries_, environment, options);
    SidePaths paths(scene_, points_, hash64(seed) + 0xc4ec, chosen);
    const std::uint64_t sides_traced = 2 * std::uint64_t(leaves.size());
    for (std::uint32_t count = std::max(kFirstPaths, traced.paths_a_side);; count *= 2) {
        progress.begin("checking by paths", scene_.patches.size());
        paths.extend_to(count, tracer, progress);
        TracedSides all = traced;
        auto add = [&](int half, std::vector<glm::vec3>& sides) {
            const std::vector<glm::vec3> more =
                chosen_sides(leaf_side_radiance(scene_, paths.radiance(optics, half)), leaves);
            sides.insert(sides.end(), more.begin(), more.end());
        };
        all.leaves.insert(all.leaves.end(), leaves.begin(), leaves.end());
        add(0, all.first);
        add(1, all.second);
        all.paths_a_side = count;
        MeasuredError result = error_beneath_noise(judged, all);
        result.paths = paths.paths_traced();
        const std::uint64_t most = result.uncertainty > kDoubt ? kMostPathsInDoubt : kMostPaths;
        if (result.uncertainty <= kUncertainty || 2 * count * sides_traced > most || count >= kMostPathsASide) {
            traced = std::move(all);
            return result;
        }
    }
}

} // namespace kokage::bundles
