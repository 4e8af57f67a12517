#include "reflection/maps/lobe_lights.h"
#include "common/directions/legendre.h"
#include "common/directions/lobes.h"
#include "common/environment/light_harmonics.h"
#include "common/services/parallel.h"
#include "reflection/maps/light_tree.h"
#include "reflection/maps/lobe_sums.h"
#include "reflection/maps/lobe_width.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

constexpr std::size_t kMostInGroup = 256, kVector = 16;

float channel_maximum(const glm::vec3& v) {
    return std::max({v.r, v.g, v.b});
}

/// A Gauss rule over a cone: rings of equal points at the nodes in 1 - cos, which is uniform in solid angle.
std::vector<PointOfLight> points_of_disc(const DistantLight& light, double least_spread) {
    const double half_angle = double(light.half_angle), half_sine = std::sin(0.5 * half_angle),
                 height = 2 * half_sine * half_sine; // 1 - cos
    const glm::dvec3 axis = glm::normalize(glm::dvec3(light.direction));
    if (!(half_angle > 0))
        return {{glm::vec3(axis), light.irradiance}};
    const double flux = flux_per_irradiance(half_angle); // what lobes take
    const int rings = std::clamp(2 + int(std::ceil(1.5 * half_angle / std::sqrt(least_spread))), 2, 64),
              around = 4 * rings;
    const glm::dvec3 u =
        glm::normalize(glm::cross(axis, std::abs(axis.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0)));
    const glm::dvec3 v = glm::cross(axis, u);
    std::vector<PointOfLight> points;
    const std::vector<QuadratureNode> rule = gauss_legendre(rings);
    for (std::size_t ring = 0; ring < rule.size(); ++ring) {
        const double w = 0.5 * (1 + rule[ring].x) * height, sine = std::sqrt(w * (2 - w));
        for (int i = 0; i < around; ++i) {
            const double turn = 2 * kPiDouble * (i + 0.5 * double(ring % 2)) / around;
            points.push_back({glm::vec3((1 - w) * axis + sine * (std::cos(turn) * u + std::sin(turn) * v)),
                              light.irradiance * float(0.5 * rule[ring].weight / around * flux)});
        }
    }
    return points;
}

} // namespace

ClusterOfLight cluster_of(const DistantLight& light, double least_spread) {
    ClusterOfLight cluster;
    if (light.texels.empty())
        cluster.points = points_of_disc(light, least_spread);
    for (const DistantLight::Texel& texel : light.texels)
        cluster.points.push_back({texel.direction, texel.irradiance});
    cluster.axis = glm::normalize(light.direction);
    glm::vec3 sum(0);
    for (const PointOfLight& point : cluster.points) {
        cluster.chord = std::max(cluster.chord, glm::distance(point.direction, cluster.axis));
        sum += point.irradiance;
    }
    cluster.strength = channel_maximum(sum);
    return cluster;
}

namespace {

/// Sorting: lobes of about the same width in about the same direction share a cell, about two widths across.
struct Cells {
    struct Band {
        int across;          ///< cells along a face of a cube
        std::uint32_t first; ///< cell
    };
    double widest = -1e30, octave = std::log(2.0);
    std::vector<Band> bands;
    std::uint32_t count = 0;

    Cells(double least_width, double most_width) : widest(most_width) {
        for (double width = most_width; width > least_width - octave; width -= octave) {
            const int across = std::clamp(int(std::lround(0.8 * std::exp(-0.5 * width))), 1, 128);
            bands.push_back({across, count});
            count += 6 * std::uint32_t(across * across);
        }
    }
    std::uint32_t cell(const glm::vec3& direction, double width) const {
        const auto index = std::size_t(std::max(0.0, (widest - width) / octave));
        const Band& band = bands[std::min(index, bands.size() - 1)];
        const glm::vec3 size = glm::abs(direction);
        const glm::length_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const float u = direction[(axis + 1) % 3] / size[axis], v = direction[(axis + 2) % 3] / size[axis];
        auto place = [&](float t) { return std::clamp(int(0.5f * (t + 1) * float(band.across)), 0, band.across - 1); };
        const int face = 2 * int(axis) + (direction[axis] < 0);
        return band.first + std::uint32_t((face * band.across + place(v)) * band.across + place(u));
    }
};

} // namespace

LobeLights::LobeLights(const TexelLayout& layout) : kind_(layout.kind) {
    const std::size_t count = layout.size();
    if (count == 0)
        return;
    std::vector<float> widths(count);
    parallel_blocks(count, 8192, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            widths[i] = float(std::log(std::max(lobe_spread({kind_, double(layout.parameters[i])}), 1e-12)));
    });
    const auto [least, most] = std::minmax_element(widths.begin(), widths.end());
    const Cells cells{double(*least), double(*most)};
    std::vector<std::uint32_t> cell_of(count), begin_of(std::size_t(cells.count) + 1);
    for (std::size_t i = 0; i < count; ++i)
        ++begin_of[(cell_of[i] = cells.cell(layout.directions[i], double(widths[i]))) + 1];
    for (std::size_t cell = 0; cell < cells.count; ++cell)
        begin_of[cell + 1] += begin_of[cell];
    std::vector<std::uint32_t> next(begin_of.begin(), begin_of.end() - 1);
    texels_.resize(count);
    for (std::size_t i = 0; i < count; ++i)
        texels_[next[cell_of[i]]++] = std::uint32_t(i);

    for (std::vector<float>* values : {&x_, &y_, &z_, &shape_, &peak_})
        values->resize(count + kVector);
    parallel_blocks(count, 8192, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const glm::vec3& direction = layout.directions[texels_[i]];
            const float parameter = layout.parameters[texels_[i]];
            x_[i] = direction.x;
            y_[i] = direction.y;
            z_[i] = direction.z;
            shape_[i] = kind_ == LobeKind::phong ? parameter : float(ggx_falloff(double(parameter)));
            peak_[i] = float(lobe_value({kind_, double(parameter)}, 0));
        }
    });
    for (std::size_t cell = 0; cell < cells.count; ++cell)
        for (std::uint32_t begin = begin_of[cell]; begin < begin_of[cell + 1]; begin += kMostInGroup)
            make_groups(layout, begin, std::min(begin_of[cell + 1], begin + std::uint32_t(kMostInGroup)));
}

void LobeLights::make_groups(const TexelLayout& layout, std::uint32_t begin, std::uint32_t end) {
    glm::vec3 sum(0);
    for (std::uint32_t i = begin; i < end; ++i)
        sum += glm::vec3(x_[i], y_[i], z_[i]);
    const float length = glm::length(sum);
    Group group{begin,
                end,
                length > 0 ? sum / length : glm::vec3(x_[begin], y_[begin], z_[begin]),
                0,
                layout.parameters[texels_[begin]],
                0,
                shape_[begin],
                shape_[begin]};
    double widest = 0;
    for (std::uint32_t i = begin; i < end; ++i) {
        group.chord = std::max(group.chord, glm::distance(group.axis, glm::vec3(x_[i], y_[i], z_[i])));
        group.peak = std::max(group.peak, peak_[i]);
        group.least_shape = std::min(group.least_shape, shape_[i]);
        group.most_shape = std::max(group.most_shape, shape_[i]);
        const float parameter = layout.parameters[texels_[i]];
        if (const double spread = lobe_spread({kind_, double(parameter)}); spread > widest) {
            widest = spread;
            group.widest = parameter;
        }
    }
    groups_.push_back(group);
}

std::size_t LobeLights::bytes() const {
    return groups_.size() * sizeof(Group) + texels_.size() * (sizeof(std::uint32_t) + 5 * sizeof(float));
}

namespace {

/// By a power of two, so that the strongest is about 1: no lobe's peak makes it overflow, no tail underflow.
double scale_to_one(std::vector<ClusterOfLight>& clusters) {
    float most = 0;
    for (const ClusterOfLight& cluster : clusters)
        most = std::max(most, cluster.strength);
    const float scale = most > 0 ? std::ldexp(1.f, std::clamp(-std::ilogb(most), -126, 126)) : 1.f;
    for (ClusterOfLight& cluster : clusters) {
        cluster.strength *= scale;
        for (PointOfLight& point : cluster.points)
            point.irradiance *= scale;
    }
    return double(scale);
}

} // namespace

std::uint64_t LobeLights::add(std::span<const ClusterOfLight> lights, float negligible, std::span<const float> factors,
                              std::span<glm::vec3> filtered) const {
    constexpr std::size_t kBlock = 64;
    std::vector<ClusterOfLight> clusters(lights.begin(), lights.end());
    const double scale = scale_to_one(clusters);
    const std::vector<LightTree> trees(clusters.begin(), clusters.end());
    std::vector<std::uint64_t> evaluated((groups_.size() + kBlock - 1) / kBlock);
    parallel_blocks(groups_.size(), kBlock, [&](std::size_t first, std::size_t last) {
        std::vector<PointOfLight> near;
        alignas(64) float sums[3 * (kMostInGroup + kVector)];
        for (std::size_t g = first; g < last; ++g) {
            const Group& group = groups_[g];
            near.clear();
            float allowed =
                float(scale *
                      double(negligible)); // before the factors, which are large where narrow lobes lie between pixels
            if (!factors.empty()) {
                float most = 0;
                for (std::uint32_t i = group.begin; i < group.end; ++i)
                    most = std::max(most, factors[texels_[i]]);
                if (most == 0)
                    continue;
                allowed /= std::max(most, 1.f);
            }
            const LobeBounds bounds{kind_, group.peak, group.least_shape, group.most_shape};
            for (std::size_t i = 0; i < clusters.size(); ++i) {
                const ClusterOfLight& cluster = clusters[i];
                const double share = double(allowed) / (double(cluster.strength) * double(group.peak));
                if (!(share < 1))
                    continue;
                // Distances between unit directions add up to more than the distance.
                const float reach = float(std::sqrt(lobe_reach({kind_, double(group.widest)}, share))) + group.chord;
                if (glm::distance(group.axis, cluster.axis) > reach + cluster.chord)
                    continue;
                trees[i].gather(group.axis, group.chord, reach, bounds, allowed, near);
            }
            if (near.empty())
                continue;
            const std::size_t count = group.end - group.begin, at = group.begin, stride = kMostInGroup + kVector;
            evaluated[first / kBlock] += count * near.size();
            sum_lobes(kind_,
                      {x_.data() + at, y_.data() + at, z_.data() + at, shape_.data() + at, peak_.data() + at, count},
                      near, sums, stride);
            for (std::size_t i = 0; i < count; ++i) {
                const std::uint32_t texel = texels_[at + i];
                const double factor = (factors.empty() ? 1.0 : double(factors[texel])) / scale;
                filtered[texel] += glm::vec3(factor * glm::dvec3(sums[i], sums[stride + i], sums[2 * stride + i]));
            }
        }
    });
    std::uint64_t all = 0;
    for (const std::uint64_t count : evaluated)
        all += count;
    return all;
}

} // namespace kokage
