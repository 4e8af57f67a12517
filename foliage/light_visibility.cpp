#include "foliage/light_visibility.h"
#include "common/services/parallel.h"
#include "common/services/random.h"

#include <bit>
#include <cmath>
#include <utility>

namespace kokage {

namespace {

std::uint64_t mix(std::uint64_t key, float value) {
    return hash64(key ^ std::bit_cast<std::uint32_t>(value));
}

std::uint64_t mix(std::uint64_t key, const glm::vec3& value) {
    return mix(mix(mix(key, value.x), value.y), value.z);
}

/// A light of one direction needs one ray.
int samples_needed(const DistantLight& light, int samples) {
    return light.half_angle > 0 || light.texels.size() > 1 ? samples : 1;
}

} // namespace

std::uint64_t shape_key(const DistantLight& light) {
    std::uint64_t key = mix(mix(1, light.direction), light.half_angle);
    for (const DistantLight::Texel& texel : light.texels)
        key = mix(mix(mix(key, texel.direction), texel.irradiance), texel.half_angle);
    return key;
}

std::uint64_t shape_key(const PointLight& light) {
    return mix(2, light.position);
}

glm::vec3 facing_irradiance(const PointLight& light, const glm::vec3& point, float least_m) {
    const float distance = std::max(glm::distance(light.position, point), least_m);
    return light.intensity / distance / distance;
}

LightVisibility::LightVisibility(const RayQueries& queries, std::vector<CapturePoint> points, int samples,
                                 std::uint64_t seed)
    : queries_(queries), points_(std::move(points)), samples_(samples), seed_(seed) {}

LightVisibility::Entry* LightVisibility::find(std::uint64_t key) {
    const auto found = entries_.find(key);
    if (found == entries_.end())
        return nullptr;
    found->second.used = true;
    return &found->second;
}

const std::vector<float>& LightVisibility::of(const DistantLight& light, Progress& progress) {
    const std::uint64_t key = shape_key(light);
    if (const Entry* entry = find(key))
        return entry->visible;
    const int samples = samples_needed(light, samples_);
    std::vector<float> visible(points_.size(), 0.f);
    parallel_blocks(points_.size(), 64, [&](std::size_t begin, std::size_t end) {
        progress.throw_if_stopped();
        for (std::size_t p = begin; p < end; ++p) {
            Random random(seed_, hash64(key) + p);
            int open = 0;
            for (int s = 0; s < samples; ++s) {
                const float u0 = (float(s) + random.uniform()) / float(samples), u1 = random.uniform();
                const LightSample sample = sample_light(light, u0, u1);
                RayHit hit;
                open += !first_hit_outside_wood(queries_, points_[p], sample.direction,
                                                std::numeric_limits<float>::infinity(), hit);
            }
            visible[p] = float(open) / float(samples);
        }
    });
    rays_ += points_.size() * std::size_t(samples);
    return entries_.emplace(key, Entry{std::move(visible)}).first->second.visible;
}

const std::vector<float>& LightVisibility::of(const PointLight& light, Progress& progress) {
    const std::uint64_t key = shape_key(light);
    if (const Entry* entry = find(key))
        return entry->visible;
    std::vector<float> visible(points_.size(), 1.f);
    parallel_blocks(points_.size(), 64, [&](std::size_t begin, std::size_t end) {
        progress.throw_if_stopped();
        for (std::size_t p = begin; p < end; ++p) {
            const glm::vec3 to = light.position - points_[p].position;
            const float distance = glm::length(to);
            if (!(distance > 0))
                continue; // at the light itself
            RayHit hit;
            visible[p] = first_hit_outside_wood(queries_, points_[p], to / distance, distance, hit) ? 0.f : 1.f;
        }
    });
    rays_ += points_.size();
    return entries_.emplace(key, Entry{std::move(visible)}).first->second.visible;
}

void LightVisibility::forget_unused() {
    std::erase_if(entries_, [](const auto& item) { return !item.second.used; });
    for (auto& [key, entry] : entries_)
        entry.used = false;
}

std::size_t LightVisibility::bytes() const {
    return points_.size() * (sizeof(CapturePoint) + entries_.size() * sizeof(float));
}

} // namespace kokage
