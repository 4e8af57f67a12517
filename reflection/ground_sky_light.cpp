#include "reflection/ground_sky_light.h"
#include "common/services/parallel.h"
#include "reflection/sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kokage {
namespace {

constexpr int kNodes = 40;
constexpr int kLevels = 6;
constexpr float kReach = 8;    ///< of the coarsest grid, in scene radii
constexpr float kBlend = 0.2f; ///< outer share of a grid that fades into the next
constexpr std::uint32_t kDirections = 256;
constexpr std::uint32_t kOpenDirections = 1u << 16;
constexpr std::uint32_t kPattern = 0x6b6f6b61u;

float smooth_step(float t) {
    t = std::clamp(t, 0.f, 1.f);
    return t * t * (3 - 2 * t);
}

/// Mean place (x, z) of the corners in the lowest twentieth of the scene: where it stands.
glm::vec2 standing_place(const PatchScene& patches, const Bounds& bounds) {
    const float limit = bounds.low.y + 0.05f * (bounds.high.y - bounds.low.y);
    glm::dvec2 sum(0.0);
    double count = 0;
    for (const glm::uvec3& triangle : patches.triangles)
        for (std::size_t k = 0; k < 3; ++k)
            if (const glm::vec3& p = patches.positions[triangle[k]]; p.y <= limit) {
                sum += glm::dvec2(p.x, p.z);
                ++count;
            }
    return count > 0 ? glm::vec2(sum / count) : glm::vec2(bounds.centre().x, bounds.centre().z);
}

} // namespace

float GroundSkyLight::Level::weight(const glm::vec2& place) const {
    const glm::vec2 offset = glm::abs(place - centre);
    return smooth_step((1 - std::max(offset.x, offset.y) / half_width) / kBlend);
}

glm::vec2 GroundSkyLight::Level::node_place(int column, int row) const {
    return centre + half_width * (2.f * glm::vec2(column, row) / float(kNodes - 1) - 1.f);
}

glm::vec3 GroundSkyLight::Level::interpolated(const glm::vec2& place) const {
    const glm::vec2 grid = ((place - centre) / half_width * 0.5f + 0.5f) * float(kNodes - 1);
    const int column = int(std::floor(grid.x)), row = int(std::floor(grid.y));
    const glm::vec4 wx = cubic_b_spline(grid.x - float(column)), wz = cubic_b_spline(grid.y - float(row));
    glm::vec3 sum(0.f);
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i) {
            const int x = std::clamp(column + i - 1, 0, kNodes - 1), z = std::clamp(row + j - 1, 0, kNodes - 1);
            sum += wx[std::size_t(i)] * wz[std::size_t(j)] * nodes[std::size_t(z * kNodes + x)];
        }
    return sum;
}

glm::vec3 GroundSkyLight::open_irradiance(const Backdrop& backdrop) {
    glm::dvec3 open(0.0);
    for (std::uint32_t k = 0; k < kOpenDirections; ++k)
        open += glm::dvec3(backdrop.remainder(cosine_direction(multi_jittered(k, kOpenDirections, kPattern))));
    return glm::vec3(open * (kPiDouble / kOpenDirections));
}

GroundSkyLight::GroundSkyLight(const ShadedScene& scene, const RayQueries& queries, const Backdrop& backdrop,
                               float height, Progress& progress)
    : open_(open_irradiance(backdrop)) {
    if (scene.patches->triangles.empty())
        return;
    place_levels(*scene.patches);
    gather(scene, queries, backdrop, height, progress);
}

void GroundSkyLight::place_levels(const PatchScene& patches) {
    const Bounds bounds = bounds_of(patches);
    const glm::vec3 half = 0.5f * (bounds.high - bounds.low);
    const float radius = std::max({half.x, half.z, 0.5f * half.y, std::numeric_limits<float>::min() * 1e6f});
    const glm::vec2 middle(bounds.centre().x, bounds.centre().z), standing = standing_place(patches, bounds);
    for (int k = 0; k < kLevels; ++k) {
        const float half_width = kReach * radius * std::ldexp(1.f, -k);
        levels_.push_back({half_width > 1.5f * radius ? middle : standing, half_width,
                           std::vector<glm::vec3>(std::size_t(kNodes) * kNodes, glm::vec3(0.f))});
    }
}

/// True if a finer grid is all that is seen wherever this node has a share (two cells around it, by the B-spline).
bool GroundSkyLight::hidden_by_finer(std::size_t level, int column, int row) const {
    if (level + 1 == levels_.size())
        return false;
    const Level& finer = levels_[level + 1];
    const float reach = 2 * 2 * levels_[level].half_width / float(kNodes - 1);
    const glm::vec2 offset = glm::abs(levels_[level].node_place(column, row) - finer.centre) + reach;
    return std::max(offset.x, offset.y) < (1 - kBlend) * finer.half_width;
}

void GroundSkyLight::gather(const ShadedScene& scene, const RayQueries& queries, const Backdrop& backdrop, float height,
                            Progress& progress) {
    std::vector<glm::vec3> directions(kDirections), sky(kDirections);
    for (std::uint32_t k = 0; k < kDirections; ++k) {
        directions[k] = cosine_direction(multi_jittered(k, kDirections, kPattern));
        sky[k] = backdrop.remainder(directions[k]);
    }
    struct Node {
        std::size_t level;
        int column, row;
    };
    std::vector<Node> nodes;
    for (std::size_t level = 0; level < levels_.size(); ++level)
        for (int row = 0; row < kNodes; ++row)
            for (int column = 0; column < kNodes; ++column)
                if (!hidden_by_finer(level, column, row))
                    nodes.push_back({level, column, row});

    progress.begin("lighting the ground", nodes.size());
    const float near = queries.ray_offset(), far = std::numeric_limits<float>::infinity();
    constexpr std::size_t kAtOnce = 64;
    parallel_blocks(nodes.size(), kAtOnce, [&](std::size_t begin, std::size_t end) {
        progress.throw_if_stopped();
        std::vector<Ray> rays;
        for (std::size_t n = begin; n < end; ++n) {
            const glm::vec2 place = levels_[nodes[n].level].node_place(nodes[n].column, nodes[n].row);
            rays.push_back({{place.x, height, place.y}, {}, near, far});
        }
        std::vector<RayHit> hits(rays.size());
        std::vector<std::uint8_t> found(rays.size());
        std::vector<glm::dvec3> changes(rays.size(), glm::dvec3(0.0));
        for (std::uint32_t k = 0; k < kDirections;
             ++k) { // neighbours' rays in one direction are parallel: they meet alike
            for (Ray& ray : rays)
                ray.direction = directions[k];
            queries.first_hits(rays, hits, found);
            for (std::size_t i = 0; i < rays.size(); ++i) {
                if (!found[i] || hits[i].ground)
                    continue;
                const std::uint32_t patch = scene.patches->triangle_patch[hits[i].triangle];
                const bool front = glm::dot(directions[k], hits[i].geometric_normal) < 0;
                changes[i] += glm::dvec3((front ? scene.radiance_front[patch] : scene.radiance_back[patch]) - sky[k]);
            }
        }
        for (std::size_t n = begin; n < end; ++n)
            levels_[nodes[n].level].nodes[std::size_t(nodes[n].row * kNodes + nodes[n].column)] =
                glm::vec3(changes[n - begin] * (kPiDouble / kDirections));
        progress.advance(end - begin);
    });
}

glm::vec3 GroundSkyLight::irradiance(float x, float z) const {
    const glm::vec2 place(x, z);
    glm::vec3 change(0.f);
    float open = 1; // share that is not covered by a finer grid yet
    for (std::size_t k = levels_.size(); k-- > 0 && open > 0;)
        if (const float weight = levels_[k].weight(place); weight > 0) {
            change += open * weight * levels_[k].interpolated(place);
            open *= 1 - weight;
        }
    return glm::max(open_ + change, glm::vec3(0.f));
}

} // namespace kokage
