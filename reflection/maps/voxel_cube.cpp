#include "reflection/maps/voxel_cube.h"

#include "common/services/error.h"
#include "common/services/parallel.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <ranges>
#include <string>

namespace kokage {
namespace {

constexpr double kSlack = 1e-3; ///< lookups are done in float

void check(int s, const SmoothnessRange& range) {
    if (s < 4 || s > 1022 || s % 2 != 0)
        throw InputError("voxel cube of size " + std::to_string(s) + ": ask for an even size from 4 to 1022");
    if (!(range.roughest >= 0 && range.roughest <= range.smoothest && range.smoothest <= 1))
        throw InputError("voxel cube of smoothness " + std::to_string(range.roughest) + " to " +
                         std::to_string(range.smoothest) + ": ask for a range within 0 and 1, the rough end first");
}

/// Where lookups of a range are done: between two spheres around the centre, in voxels.
struct LookedUp {
    LookedUp(int s, const SmoothnessRange& range)
        : least(distance(s, range.roughest) - kSlack), most(distance(s, range.smoothest) + kSlack) {}
    /// Whether a trilinear lookup between the spheres can read the voxel at `offset` from the centre: whether one of
    /// the cells that it belongs to reaches between them.
    bool reads(const glm::dvec3& offset) const {
        const glm::dvec3 farthest = glm::abs(offset) + 1.0, nearest = glm::max(farthest - 2.0, glm::dvec3(0));
        return glm::length(nearest) <= most && glm::length(farthest) >= least;
    }
    /// Even, as s is, and enough for a cell around any place within.
    int width() const { return 2 * int(std::ceil(most + 0.5)); }
    double least, most;

  private:
    static double distance(int s, double smoothness) {
        return std::min(std::hypot(smoothness * s / 2.0, double(VoxelCube::centre_radius)), s / 2.0);
    }
};

} // namespace

VoxelCube::Extent VoxelCube::extent(int cube_size, const SmoothnessRange& range) {
    check(cube_size, range);
    const LookedUp looked_up(cube_size, range);
    Extent extent{looked_up.width(), 0};
    // An eighth of it; along a row, voxels that are read stand together.
    const int half = extent.size / 2;
    for (int z = 0; z < half; ++z)
        for (int y = 0; y < half; ++y) {
            const auto far_enough = [&](int x) { return glm::length(glm::dvec3(x, y, z) + 1.5) >= looked_up.least; };
            const auto read_or_nearer = [&](int x) {
                return !far_enough(x) || looked_up.reads(glm::dvec3(x, y, z) + 0.5);
            };
            const auto numbers = std::views::iota(0, half);
            const auto first = std::ranges::partition_point(numbers, std::not_fn(far_enough));
            extent.texels += 8 * std::size_t(std::ranges::partition_point(numbers, read_or_nearer) - first);
        }
    return extent;
}

VoxelCube::VoxelCube(LobeKind kind, const RoughnessScale& scale, const SmoothnessRange& range)
    : range_(range), size_(extent(scale.cube_size(), range).size), scale_(scale) {
    const double radius = scale.cube_size() / 2.0, centre = (size_ - 1) / 2.0;
    const LookedUp looked_up(scale.cube_size(), range);
    const std::size_t texels = extent(scale.cube_size(), range).texels;
    layout_.kind = kind;
    layout_.directions.reserve(texels);
    layout_.parameters.reserve(texels);
    voxel_of_texel_.reserve(texels);
    std::vector<float> known(3 * std::size_t(size_) * std::size_t(size_) / 8 + 1, -1.f); // by distance
    std::size_t voxel = 0;
    for (int z = 0; z < size_; ++z)
        for (int y = 0; y < size_; ++y)
            for (int x = 0; x < size_; ++x, ++voxel) {
                const glm::dvec3 offset = glm::dvec3(x, y, z) - centre;
                if (!looked_up.reads(offset))
                    continue;
                const double distance = glm::length(offset);
                layout_.directions.push_back(offset / distance);
                // Twice the offsets are odd, and the sum of their squares 3 more than a multiple of 8.
                float& parameter = known[std::size_t(std::lround(4 * glm::dot(offset, offset))) / 8];
                if (parameter < 0) {
                    const double exponent = scale.exponent(distance / radius);
                    parameter = float(kind == LobeKind::phong ? exponent : roughness_from_exponent(exponent));
                }
                layout_.parameters.push_back(parameter);
                voxel_of_texel_.push_back(voxel);
            }
    voxels_.assign(voxel, glm::vec3(0));
}

void VoxelCube::set_texels(std::span<const glm::vec3> filtered) {
    if (filtered.size() != voxel_of_texel_.size())
        throw InputError("voxel cube: " + std::to_string(filtered.size()) + " texels given, its layout has " +
                         std::to_string(voxel_of_texel_.size()));
    for (std::size_t i = 0; i < filtered.size(); ++i)
        voxels_[voxel_of_texel_[i]] = filtered[i];
}

float VoxelCube::smoothness(double parameter) const {
    const double exponent = layout_.kind == LobeKind::phong ? parameter : exponent_from_roughness(parameter);
    return float(std::min(scale_.smoothness(exponent), 1.0));
}

glm::vec3 VoxelCube::lookup(const glm::vec3& direction, float smoothness) const {
    const float sphere = 0.5f * float(scale_.cube_size());
    const float wanted = sphere * std::clamp(smoothness, float(range_.roughest), float(range_.smoothest));
    const float radius = std::min(std::sqrt(wanted * wanted + centre_radius * centre_radius), sphere);
    const glm::vec3 place = 0.5f * float(size_ - 1) + radius * direction;
    const glm::ivec3 cell = glm::clamp(glm::ivec3(place), 0, size_ - 2);
    const glm::vec3 f = place - glm::vec3(cell);
    const std::size_t row = std::size_t(size_), slice = row * row;
    const glm::vec3* v = voxels_.data() + std::size_t(cell.z) * slice + std::size_t(cell.y) * row + std::size_t(cell.x);
    const auto line = [&](const glm::vec3* p) { return p[0] + f.x * (p[1] - p[0]); };
    const auto square = [&](const glm::vec3* p) { return glm::mix(line(p), line(p + row), f.y); };
    return glm::mix(square(v), square(v + slice), f.z);
}

void VoxelCube::lookup(std::span<const glm::vec3> directions, std::span<const float> smoothness,
                       std::span<glm::vec3> filtered) const {
    parallel_blocks(directions.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            filtered[i] = lookup(directions[i], smoothness[i]);
    });
}

} // namespace kokage
