#include "reflection/maps/voxel_cube.h"

#include "common/services/error.h"
#include "common/services/parallel.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace kokage {
namespace {

int checked_size(int s) {
    if (s < 4 || s > 1022 || s % 2 != 0)
        throw InputError("voxel cube of size " + std::to_string(s) + ": ask for an even size from 4 to 1022");
    return s + 2;
}

/// Whether a trilinear lookup within `radius` voxels of the centre can read the voxel at `offset` from it: whether the
/// nearest corner of the nearest cell that it belongs to lies within.
bool is_read(const glm::dvec3& offset, double radius) {
    const glm::dvec3 nearest = glm::max(glm::abs(offset) - 1.0, glm::dvec3(0));
    const double slack = 1e-3; // lookups are done in float
    return glm::length(nearest) <= radius + slack;
}

} // namespace

VoxelCube::VoxelCube(LobeKind kind, const RoughnessScale& scale)
    : size_(checked_size(scale.cube_size())), scale_(scale) {
    const double radius = scale.cube_size() / 2.0, centre = (size_ - 1) / 2.0;
    layout_.kind = kind;
    std::size_t voxel = 0;
    for (int z = 0; z < size_; ++z)
        for (int y = 0; y < size_; ++y)
            for (int x = 0; x < size_; ++x, ++voxel) {
                const glm::dvec3 offset = glm::dvec3(x, y, z) - centre;
                if (!is_read(offset, radius))
                    continue;
                const double distance = glm::length(offset), exponent = scale.exponent(distance / radius);
                layout_.directions.push_back(offset / distance);
                layout_.parameters.push_back(
                    float(kind == LobeKind::phong ? exponent : std::min(roughness_from_exponent(exponent), 1.0)));
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
    const float sphere = 0.5f * float(size_ - 2), wanted = sphere * std::clamp(smoothness, 0.f, 1.f);
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
