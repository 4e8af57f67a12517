#include "foliage/first_light_by_rays.h"
#include "common/services/parallel.h"
#include "foliage/patch_sampling.h"

#include <cmath>

namespace kokage {

namespace {

constexpr std::uint16_t kNoSky = 0xffff;
constexpr int kSkyCells = 2 * 32 * 32; // 6 degrees a cell: the remainder is smooth

/// Both coordinates stratified: the golden ratio's steps are even at any count.
float golden(int i, float offset) {
    const float x = offset + 0.61803398875f * float(i);
    return x - std::floor(x);
}

} // namespace

FirstLightByRays::FirstLightByRays(const RayQueries& queries, int rays_a_side, int light_rays, std::uint64_t seed,
                                   Progress& progress)
    : queries_(queries), rays_a_side_(rays_a_side), light_rays_(light_rays), seed_(seed),
      cells_(make_capture_directions(1, kSkyCells)) {
    const PatchScene& scene = queries.scene();
    const std::size_t rays = std::size_t(rays_a_side);
    seen_cell_.assign(scene.patches.size() * 2 * rays, kNoSky);
    progress.begin("tracing the open sky", scene.patches.size());
    parallel_blocks(scene.patches.size(), 256, [&](std::size_t begin, std::size_t end) {
        progress.throw_if_stopped();
        for (std::size_t p = begin; p < end; ++p) {
            Random random(seed, p);
            const int sides = scene.patches[p].kind == PatchKind::bark ? 1 : 2;
            for (int side = 0; side < sides; ++side) {
                const float offset = random.uniform();
                for (int i = 0; i < rays_a_side; ++i) {
                    const PatchPoint point = sample_patch(scene, std::uint32_t(p), random);
                    const glm::vec3 normal = side == 0 ? point.normal : -point.normal;
                    const float u0 = (float(i) + random.uniform()) / float(rays_a_side);
                    const glm::vec3 direction = cosine_direction(normal, u0, golden(i, offset));
                    if (!queries.occluded(point.position, direction, queries.ray_offset(),
                                          std::numeric_limits<float>::infinity()))
                        seen_cell_[(2 * p + std::size_t(side)) * rays + std::size_t(i)] =
                            std::uint16_t(cells_.cell(direction));
                }
            }
        }
        progress.advance(end - begin);
    });
    rays_ += seen_cell_.size();
}

/// Per patch and light ray, `sample(random, i, point, direction, distance)` gives a direction and how strong the light
/// is there.
template <class Sample>
const std::vector<glm::vec2>& FirstLightByRays::trace_light(std::uint64_t key, const Sample& sample,
                                                            Progress& progress) {
    if (const auto found = lights_.find(key); found != lights_.end()) {
        found->second.used = true;
        return found->second.sides;
    }
    const PatchScene& scene = queries_.scene();
    std::vector<glm::vec2> sides(scene.patches.size(), glm::vec2(0.f));
    parallel_blocks(scene.patches.size(), 256, [&](std::size_t begin, std::size_t end) {
        progress.throw_if_stopped();
        for (std::size_t p = begin; p < end; ++p) {
            Random random(seed_ ^ key, p);
            const bool bark = scene.patches[p].kind == PatchKind::bark;
            for (int i = 0; i < light_rays_; ++i) {
                const PatchPoint point = sample_patch(scene, std::uint32_t(p), random);
                glm::vec3 direction;
                float distance = std::numeric_limits<float>::infinity(), strength = 1;
                sample(random, i, point.position, direction, distance, strength);
                const float cosine = glm::dot(direction, point.normal);
                if (cosine == 0 || (bark && cosine < 0))
                    continue;
                if (!queries_.occluded(point.position, direction, queries_.ray_offset(), distance))
                    (cosine > 0 ? sides[p].x : sides[p].y) += std::abs(cosine) * strength;
            }
            sides[p] /= float(light_rays_);
        }
    });
    rays_ += scene.patches.size() * std::size_t(light_rays_);
    return lights_.emplace(key, LightTransfer{std::move(sides)}).first->second.sides;
}

const std::vector<glm::vec2>& FirstLightByRays::transfer(const DistantLight& light, Progress& progress) {
    return trace_light(
        shape_key(light),
        [&](Random& random, int i, const glm::vec3&, glm::vec3& direction, float&, float&) {
            const float u0 = (float(i) + random.uniform()) / float(light_rays_), u1 = random.uniform();
            direction = sample_light(light, u0, u1).direction;
        },
        progress);
}

const std::vector<glm::vec2>& FirstLightByRays::transfer(const PointLight& light, Progress& progress) {
    return trace_light(
        shape_key(light),
        [&](Random&, int, const glm::vec3& point, glm::vec3& direction, float& distance, float& strength) {
            const glm::vec3 to = light.position - point;
            distance = std::max(glm::length(to), queries_.ray_offset());
            direction = to / distance;
            strength = 1 / distance / distance;
        },
        progress);
}

FirstLight FirstLightByRays::of(const Environment& environment, Progress& progress) {
    const std::size_t patches = queries_.scene().patches.size(), rays = std::size_t(rays_a_side_);
    const std::vector<glm::vec3> zero(patches, glm::vec3(0.f));
    FirstLight light{{zero, zero}, {zero, zero}, std::vector<float>(patches), std::vector<float>(patches), zero};
    const std::vector<glm::vec3> sky = cell_means(cells_, environment.remainder);
    parallel_blocks(patches, 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) {
            glm::vec3 open_direction{0.f};
            for (std::size_t side = 0; side < 2; ++side) {
                glm::vec3 sum{0.f};
                int open = 0;
                for (std::size_t i = 0; i < rays; ++i)
                    if (const std::uint16_t cell = seen_cell_[(2 * p + side) * rays + i]; cell != kNoSky) {
                        sum += sky[cell];
                        open_direction += cells_.directions[cell];
                        ++open;
                    }
                (side == 0 ? light.sky.front : light.sky.back)[p] = sum * (kPi / float(rays));
                (side == 0 ? light.open_front : light.open_back)[p] = float(open) / float(rays);
            }
            const float length = glm::length(open_direction);
            light.bent_normal[p] = length > 1e-6f ? open_direction / length : glm::vec3(0.f);
        }
    });
    const auto add = [&](const std::vector<glm::vec2>& sides, const glm::vec3& colour) {
        for (std::size_t p = 0; p < patches; ++p) {
            light.lights.front[p] += sides[p].x * colour;
            light.lights.back[p] += sides[p].y * colour;
        }
    };
    for (const DistantLight& distant : environment.distant_lights)
        add(transfer(distant, progress), distant.irradiance);
    for (const PointLight& point : environment.point_lights)
        add(transfer(point, progress), point.intensity);
    std::erase_if(lights_, [](const auto& item) { return !item.second.used; });
    for (auto& [key, entry] : lights_)
        entry.used = false;
    return light;
}

std::size_t FirstLightByRays::bytes() const {
    return seen_cell_.size() * sizeof(std::uint16_t) +
           lights_.size() * queries_.scene().patches.size() * sizeof(glm::vec2);
}

} // namespace kokage
