#include "tests/benchmark/map_truth.h"
#include "common/services/parallel.h"
#include "common/services/random.h"
#include "reflection/maps/brute_force_baker.h"
#include "reflection/maps/dome_pyramid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace kokage {

namespace {

TexelSample sample_of(const TexelLayout& layout, std::vector<std::size_t> texels) {
    std::sort(texels.begin(), texels.end());
    texels.erase(std::unique(texels.begin(), texels.end()), texels.end());
    TexelSample sample;
    sample.layout.kind = layout.kind;
    for (std::size_t texel : texels) {
        sample.layout.directions.push_back(layout.directions[texel]);
        sample.layout.parameters.push_back(layout.parameters[texel]);
    }
    sample.texels = std::move(texels);
    return sample;
}

} // namespace

TexelSample even_sample(const TexelLayout& layout, std::size_t count) {
    count = std::min(count, layout.size());
    std::vector<std::size_t> texels;
    Random random(1);
    for (std::size_t i = 0; i < count; ++i) { // one of each of `count` equal runs of texels
        const double begin = double(i) * double(layout.size()) / double(count);
        const double length = double(layout.size()) / double(count);
        texels.push_back(std::min(std::size_t(begin + random.uniform_double() * length), layout.size() - 1));
    }
    return sample_of(layout, std::move(texels));
}

TexelSample sample_of_all_shells(const TexelLayout& layout, std::size_t count) {
    constexpr std::size_t kShells = 40;
    const auto [least, most] = std::minmax_element(layout.parameters.begin(), layout.parameters.end());
    const double low = std::log1p(double(*least)), span = std::max(std::log1p(double(*most)) - low, 1e-9);
    std::vector<std::vector<std::size_t>> shells(kShells);
    for (std::size_t t = 0; t < layout.size(); ++t) {
        const double place = (std::log1p(double(layout.parameters[t])) - low) / span;
        shells[std::min(std::size_t(place * kShells), kShells - 1)].push_back(t);
    }
    std::vector<std::size_t> texels;
    for (std::size_t s = 0; s < kShells; ++s) {
        Random random(2, s);
        for (std::size_t i = 0; i < count / kShells && !shells[s].empty(); ++i)
            texels.push_back(shells[s][random.below(std::uint32_t(shells[s].size()))]);
    }
    return sample_of(layout, std::move(texels));
}

std::vector<glm::vec3> true_texels(const TexelSample& sample, const Environment& surroundings) {
    std::vector<glm::vec3> truth(sample.layout.size());
    WorkReport report;
    brute_force_baker(sample.layout, surroundings.remainder.width, surroundings.remainder.height)
        ->bake(surroundings, truth, report);
    return truth;
}

std::vector<glm::vec3> true_texels_by_dome(const TexelSample& sample, const Image& image) {
    const std::vector<glm::dvec3>& directions = dome_of_level(0).dome.directions;
    const std::vector<glm::vec3> light = light_on_domes(image)[0];
    std::vector<glm::vec3> truth(sample.layout.size());
    parallel_blocks(truth.size(), 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            const Lobe lobe{sample.layout.kind, double(sample.layout.parameters[t])};
            const glm::dvec3 axis = glm::normalize(glm::dvec3(sample.layout.directions[t]));
            const double reach = lobe_reach(lobe, 1e-12);
            glm::dvec3 sum(0);
            double mass = 0;
            for (std::size_t v = 0; v < directions.size(); ++v) {
                const glm::dvec3 apart = directions[v] - axis;
                const double squared = glm::dot(apart, apart);
                if (squared > reach)
                    continue;
                const double weight = lobe_value(lobe, squared);
                sum += weight * glm::dvec3(light[v]);
                mass += weight;
            }
            truth[t] = glm::vec3(sum / mass);
        }
    });
    return truth;
}

std::vector<glm::vec3> values_at(const TexelSample& sample, std::span<const glm::vec3> filtered) {
    std::vector<glm::vec3> values;
    for (std::size_t texel : sample.texels)
        values.push_back(filtered[texel]);
    return values;
}

void judge(std::span<const glm::vec3> values, std::span<const glm::vec3> truth, ReflectionRecord& record) {
    if (values.size() != truth.size() || values.empty())
        throw std::invalid_argument("errors need as many values as truths, and at least one");
    constexpr double kLeastShare = 1e-3; // of the mean: the smallest denominator of a relative error
    double mean = 0;
    for (const glm::vec3& t : truth)
        mean += double(t.x + t.y + t.z) / 3 / double(truth.size());
    double sum = 0, most = 0, relative_sum = 0, most_relative = 0;
    for (std::size_t i = 0; i < truth.size(); ++i)
        for (glm::length_t c = 0; c < 3; ++c) {
            const double error = std::abs(double(values[i][c]) - double(truth[i][c]));
            const double relative = error / std::max({double(truth[i][c]), kLeastShare * mean, 1e-300});
            sum += error;
            relative_sum += relative;
            most = std::max(most, error);
            most_relative = std::max(most_relative, relative);
        }
    const double count = 3 * double(truth.size());
    if (!std::isfinite(sum)) // std::max passes NaN over
        most = most_relative = std::numeric_limits<double>::quiet_NaN();
    record.mean_error_255 = 255 * sum / count;
    record.max_error_255 = 255 * most;
    record.mean_relative_error = relative_sum / count;
    record.max_relative_error = most_relative;
}

} // namespace kokage
