#include "foliage/ground_light.h"
#include "common/services/parallel.h"

#include <algorithm>

namespace kokage {

namespace {

constexpr int kLeastDirections = 2 * 12 * 12; // of the whole sphere; an even number of rings has none on the horizon
constexpr int kLightSamples = 8;

std::vector<CapturePoint> cell_centres(const GroundCells& grid) {
    std::vector<CapturePoint> centres;
    for (std::size_t cell = 0; cell + 1 < grid.size(); ++cell)
        centres.push_back({grid.centre(cell), 0.f});
    return centres;
}

/// Irradiance of an unshadowed distant light on the upward plane.
glm::vec3 on_level_ground(const DistantLight& light) {
    if (light.texels.empty())
        return light.irradiance * std::max(0.f, light.direction.y);
    glm::vec3 sum{0.f};
    for (const DistantLight::Texel& texel : light.texels)
        sum += texel.irradiance * std::max(0.f, texel.direction.y);
    return sum;
}

} // namespace

glm::vec3 seen_radiance(std::uint32_t seen, const SideRadiance& tree, std::span<const glm::vec3> ground) {
    if (seen == kSeesSky)
        return glm::vec3(0.f);
    const std::size_t patch = seen / 2;
    if (patch >= tree.front.size())
        return ground.empty() ? glm::vec3(0.f) : ground[seen - 2 * tree.front.size()];
    return seen % 2 == 0 ? tree.front[patch] : tree.back[patch];
}

GroundLight::GroundLight(const RayQueries& queries, std::uint64_t seed, Progress& progress)
    : grid_(make_ground_cells(queries.scene())), sphere_(make_capture_directions(1, kLeastDirections)),
      visibility_(queries, cell_centres(grid_), kLightSamples, seed) {
    std::vector<glm::vec3> directions;
    double sum = 0;
    for (std::size_t k = 0; k < sphere_.size(); ++k)
        if (const float cosine = sphere_.directions[k].y; cosine > 0) {
            upper_.push_back(k);
            directions.push_back(sphere_.directions[k]);
            cosine_weights_.push_back(cosine * sphere_.solid_angles[k]);
            sum += cosine_weights_.back();
        }
    for (float& weight : cosine_weights_)
        weight = float(weight * kPiDouble / sum);
    capture_ = capture(queries, grid_, cell_centres(grid_), directions, progress);
    first_irradiance_.assign(grid_.size(), glm::vec3(0.f));
}

void GroundLight::set_environment(const Environment& environment, Progress& progress) {
    if (grid_.size() == 0)
        return;
    std::fill(first_irradiance_.begin(), first_irradiance_.end(), glm::vec3(0.f));
    const std::size_t far = grid_.far_cell();
    const std::vector<glm::vec3> sky = cell_means(sphere_, environment.remainder);
    for (std::size_t k = 0; k < upper_.size(); ++k) {
        const glm::vec3 weighted = cosine_weights_[k] * sky[upper_[k]];
        first_irradiance_[far] += weighted;
        for (std::size_t cell = 0; cell < far; ++cell)
            if (capture_.seen_from(cell)[k] == kSeesSky)
                first_irradiance_[cell] += weighted;
    }
    for (const DistantLight& light : environment.distant_lights) {
        const glm::vec3 open = on_level_ground(light);
        if (open == glm::vec3(0.f))
            continue;
        const std::vector<float>& visible = visibility_.of(light, progress);
        first_irradiance_[far] += open;
        for (std::size_t cell = 0; cell < far; ++cell)
            first_irradiance_[cell] += visible[cell] * open;
    }
    for (const PointLight& light : environment.point_lights) {
        const std::vector<float>& visible = visibility_.of(light, progress);
        for (std::size_t cell = 0; cell < far; ++cell) { // the far cell has no place, so a lamp does not reach it
            const glm::vec3 to = light.position - grid_.centre(cell);
            const float distance = glm::length(to);
            if (to.y > 0)
                first_irradiance_[cell] += visible[cell] * (to.y / distance) *
                                           facing_irradiance(light, grid_.centre(cell), 0.5f * grid_.cell_m);
        }
    }
    visibility_.forget_unused();
}

glm::vec3 GroundLight::irradiance_from_tree(std::size_t cell, const SideRadiance& tree) const {
    glm::vec3 sum{0.f};
    const std::span<const std::uint32_t> seen = capture_.seen_from(cell);
    for (std::size_t k = 0; k < seen.size(); ++k)
        sum += cosine_weights_[k] * seen_radiance(seen[k], tree, {});
    return sum;
}

std::vector<glm::vec3> GroundLight::radiance(const SideRadiance& tree) const {
    std::vector<glm::vec3> result(grid_.size(), glm::vec3(0.f));
    parallel_blocks(result.size(), 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t cell = begin; cell < end; ++cell) {
            glm::vec3 irradiance = first_irradiance_[cell];
            if (cell != grid_.far_cell())
                irradiance += irradiance_from_tree(cell, tree);
            result[cell] = grid_.albedo * irradiance / kPi;
        }
    });
    return result;
}

std::uint64_t GroundLight::rays_traced() const {
    return capture_.seen.size() + visibility_.rays_traced();
}

std::size_t GroundLight::bytes() const {
    return capture_.seen.size() * (sizeof(std::uint32_t) + sizeof(float)) + visibility_.bytes();
}

} // namespace kokage
