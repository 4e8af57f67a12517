#include "trees/axis_samples.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

std::vector<glm::vec3> places_of(const AxisSamples& axes) {
    std::vector<glm::vec3> places;
    places.reserve(axes.samples.size());
    for (const AxisSamples::Sample& sample : axes.samples)
        places.push_back(sample.position);
    return places;
}

} // namespace

AxisSamples sample_axes(const Skeleton& skeleton, std::size_t first_branch) {
    AxisSamples axes;
    for (std::size_t b = first_branch; b < skeleton.branches.size(); ++b) {
        const std::vector<Branch::Node>& nodes = skeleton.branches[b].nodes;
        for (std::size_t n = 0; n < nodes.size(); ++n) {
            axes.samples.push_back({nodes[n].position, nodes[n].radius_m, std::uint32_t(b)});
            if (n + 1 == nodes.size())
                break;
            const float length = glm::distance(nodes[n].position, nodes[n + 1].position);
            const float radius = std::max(nodes[n].radius_m, nodes[n + 1].radius_m);
            const int steps = radius > 0 ? int(std::clamp(std::ceil(length / radius), 1.f, 32.f)) : 4;
            for (int s = 1; s < steps; ++s) {
                const float t = float(s) / float(steps);
                axes.samples.push_back({glm::mix(nodes[n].position, nodes[n + 1].position, t),
                                        glm::mix(nodes[n].radius_m, nodes[n + 1].radius_m, t), std::uint32_t(b)});
            }
        }
    }
    return axes;
}

AxisPlace nearest_on_piece(const AxisSamples::Sample& a, const AxisSamples::Sample& b, const glm::vec3& place) {
    const glm::vec3 along = b.position - a.position;
    const float square = glm::dot(along, along);
    const float t = square > 0 ? std::clamp(glm::dot(place - a.position, along) / square, 0.f, 1.f) : 0.f;
    const glm::vec3 here = a.position + t * along;
    return {here, glm::mix(a.radius_m, b.radius_m, t), glm::distance(here, place), a.branch, true};
}

AxisPlace nearest_around(const std::vector<AxisSamples::Sample>& samples, std::size_t index, const glm::vec3& place) {
    const AxisSamples::Sample& sample = samples[index];
    AxisPlace best{sample.position, sample.radius_m, glm::distance(sample.position, place), sample.branch, true};
    const auto try_piece = [&](std::size_t first) {
        const AxisSamples::Sample &a = samples[first], &b = samples[first + 1];
        if (a.branch != b.branch)
            return;
        if (const AxisPlace on_piece = nearest_on_piece(a, b, place); on_piece.distance < best.distance)
            best = on_piece;
    };
    if (index > 0)
        try_piece(index - 1);
    if (index + 1 < samples.size())
        try_piece(index);
    return best;
}

NearestAxis::NearestAxis(const Skeleton& skeleton) : axes_(sample_axes(skeleton)), tree_(places_of(axes_)) {}

AxisPlace NearestAxis::at(const glm::vec3& place) const {
    const NearestPoint nearest = tree_.nearest(place);
    return nearest.found() ? nearest_around(axes_.samples, nearest.index, place) : AxisPlace{};
}

} // namespace kokage
