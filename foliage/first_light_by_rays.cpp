#include "foliage/first_light_by_rays.h"
#include "common/services/parallel.h"
#include "foliage/cosine_direction.h"

#include <algorithm>
#include <cmath>

namespace kokage {

namespace {

constexpr std::uint16_t kNothing = 0xffff; // other patches
constexpr int kSkyCells = 2 * 32 * 32;     // 6 degrees a cell: the remainder is smooth

/// A seed of its own for every patch, and for every use of it.
std::uint64_t patch_seed(std::uint64_t seed, std::uint64_t use, std::size_t patch) {
    return hash64(seed ^ hash64(use) ^ hash64(~std::uint64_t(patch)));
}

} // namespace

FirstLightByRays::FirstLightByRays(const RayQueries& queries, const GroundCells& ground, int rays_a_side,
                                   std::uint64_t seed, Progress& progress)
    : queries_(queries), points_(queries.scene()), rays_a_side_(rays_a_side), seed_(seed),
      cells_(make_capture_directions(1, kSkyCells)), ground_(ground) {
    const PatchScene& scene = queries.scene();
    const std::size_t rays = std::size_t(rays_a_side);
    seen_cell_.assign(scene.patches.size() * 2 * rays, kNothing);
    progress.begin("tracing the open sky", scene.patches.size());
    parallel_blocks(scene.patches.size(), 256, [&](std::size_t begin, std::size_t end) {
        progress.throw_if_stopped();
        for (std::size_t p = begin; p < end; ++p) {
            const int sides = scene.patches[p].kind == PatchKind::bark ? 1 : 2;
            for (int side = 0; side < sides; ++side)
                for (int i = 0; i < rays_a_side; ++i) {
                    PathNumbers numbers(patch_seed(seed, std::uint64_t(side), p), std::uint32_t(i));
                    PatchPoint point;
                    if (!points_.sample(std::uint32_t(p), numbers, point))
                        break;
                    const glm::vec3 direction =
                        cosine_direction(side == 0 ? point.normal : -point.normal, numbers.pair());
                    seen_cell_[(2 * p + std::size_t(side)) * rays + std::size_t(i)] = look(point.position, direction);
                }
        }
        progress.advance(end - begin);
    });
    rays_ += seen_cell_.size();
}

/// The ground is no patch: rays go as far as its plane, and what is there is known without asking.
std::uint16_t FirstLightByRays::look(const glm::vec3& from, const glm::vec3& direction) const {
    const bool down = ground_.size() > 0 && direction.y < 0 && from.y > ground_.height_m;
    const float far = down ? (ground_.height_m - from.y) / direction.y : std::numeric_limits<float>::infinity();
    const float short_of_ground = down ? far - 2 * queries_.ray_offset() : far;
    if (queries_.occluded(from, direction, queries_.ray_offset(), short_of_ground))
        return kNothing;
    return std::uint16_t(down ? cells_.size() + ground_.cell(from + far * direction) : cells_.cell(direction));
}

/// Per patch and light ray, `sample(numbers, point, direction, distance, strength)` gives a direction and how strong
/// the light is there.
template <class Sample>
const std::vector<glm::vec2>& FirstLightByRays::trace_light(std::uint64_t light, int rays, const Sample& sample,
                                                            Progress& progress) {
    const std::uint64_t key = hash64(light + std::uint64_t(rays));
    if (const auto found = lights_.find(key); found != lights_.end()) {
        found->second.used = true;
        return found->second.sides;
    }
    const PatchScene& scene = queries_.scene();
    std::vector<glm::vec2> sides(scene.patches.size(), glm::vec2(0.f));
    parallel_blocks(scene.patches.size(), 256, [&](std::size_t begin, std::size_t end) {
        progress.throw_if_stopped();
        for (std::size_t p = begin; p < end; ++p) {
            const bool bark = scene.patches[p].kind == PatchKind::bark;
            for (int i = 0; i < rays; ++i) {
                PathNumbers numbers(patch_seed(seed_, key, p), std::uint32_t(i));
                PatchPoint point;
                if (!points_.sample(std::uint32_t(p), numbers, point))
                    break;
                glm::vec3 direction;
                float distance = std::numeric_limits<float>::infinity(), strength = 1;
                sample(numbers, point.position, direction, distance, strength);
                const float cosine = glm::dot(direction, point.normal);
                if (cosine == 0 || (bark && cosine < 0))
                    continue;
                if (!queries_.occluded(point.position, direction, queries_.ray_offset(), distance))
                    (cosine > 0 ? sides[p].x : sides[p].y) += std::abs(cosine) * strength;
            }
            sides[p] /= float(rays);
        }
    });
    rays_ += scene.patches.size() * std::size_t(rays);
    return lights_.emplace(key, LightTransfer{std::move(sides)}).first->second.sides;
}

const std::vector<glm::vec2>& FirstLightByRays::transfer(const DistantLight& light, int rays, Progress& progress) {
    return trace_light(
        shape_key(light), rays,
        [&](PathNumbers& numbers, const glm::vec3&, glm::vec3& direction, float&, float&) {
            const glm::vec2 pair = numbers.pair();
            direction = sample_light(light, pair.x, pair.y).direction;
        },
        progress);
}

const std::vector<glm::vec2>& FirstLightByRays::transfer(const PointLight& light, int rays, Progress& progress) {
    return trace_light(
        shape_key(light), rays,
        [&](PathNumbers&, const glm::vec3& point, glm::vec3& direction, float& distance, float& strength) {
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
                for (std::size_t i = 0; i < rays; ++i) {
                    const std::uint16_t cell = seen_cell_[(2 * p + side) * rays + i];
                    if (cell < cells_.size()) {
                        sum += sky[cell];
                        open_direction += cells_.directions[cell];
                        ++open;
                    }
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
    const int lights = int(environment.distant_lights.size() + environment.point_lights.size());
    const int light_rays = std::max(2, rays_a_side_ / std::max(lights, 1));
    for (const DistantLight& distant : environment.distant_lights)
        add(transfer(distant, light_rays, progress), distant.irradiance);
    for (const PointLight& point : environment.point_lights)
        add(transfer(point, light_rays, progress), point.intensity);
    std::erase_if(lights_, [](const auto& item) { return !item.second.used; });
    for (auto& [key, entry] : lights_)
        entry.used = false;
    return light;
}

SideIrradiance FirstLightByRays::from_ground(std::span<const glm::vec3> radiance) const {
    const std::size_t patches = queries_.scene().patches.size(), rays = std::size_t(rays_a_side_);
    SideIrradiance light{std::vector<glm::vec3>(patches, glm::vec3(0.f)),
                         std::vector<glm::vec3>(patches, glm::vec3(0.f))};
    if (radiance.empty())
        return light;
    parallel_blocks(patches, 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p)
            for (std::size_t side = 0; side < 2; ++side) {
                glm::vec3 sum{0.f};
                for (std::size_t i = 0; i < rays; ++i)
                    if (const std::uint16_t cell = seen_cell_[(2 * p + side) * rays + i];
                        cell >= cells_.size() && cell != kNothing)
                        sum += radiance[cell - cells_.size()];
                (side == 0 ? light.front : light.back)[p] = sum * (kPi / float(rays));
            }
    });
    return light;
}

void FirstLightByRays::filled_shares(std::vector<float>& front, std::vector<float>& back) const {
    const std::size_t patches = queries_.scene().patches.size(), rays = std::size_t(rays_a_side_);
    front.resize(patches);
    back.resize(patches);
    for (std::size_t p = 0; p < patches; ++p) {
        const auto first = seen_cell_.begin() + std::ptrdiff_t(2 * p * rays), middle = first + std::ptrdiff_t(rays);
        front[p] = float(std::count(first, middle, kNothing)) / float(rays);
        back[p] = float(std::count(middle, middle + std::ptrdiff_t(rays), kNothing)) / float(rays);
    }
}

std::size_t FirstLightByRays::bytes() const {
    return seen_cell_.size() * sizeof(std::uint16_t) +
           lights_.size() * queries_.scene().patches.size() * sizeof(glm::vec2);
}

} // namespace kokage
