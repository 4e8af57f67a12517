#include "reflection/ground_look.h"
#include "common/services/random.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kokage {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Value noise in -1 … 1 on the integer lattice, C1 between nodes.
float lattice_noise(glm::vec2 place, std::uint64_t octave) {
    const glm::vec2 cell = glm::floor(place), t = place - cell;
    const glm::vec2 s = t * t * (3.f - 2.f * t);
    auto node = [&](float dx, float dy) {
        const auto x = std::uint64_t(std::int64_t(cell.x + dx)), y = std::uint64_t(std::int64_t(cell.y + dy));
        return float(hash64(hash64(hash64(octave) ^ x) ^ y) >> 40) * 0x1p-23f - 1.f;
    };
    return (1 - s.y) * ((1 - s.x) * node(0, 0) + s.x * node(1, 0)) + s.y * ((1 - s.x) * node(0, 1) + s.x * node(1, 1));
}

} // namespace

glm::vec3 ground_variation(glm::vec2 place, float size, float finest, float spread) {
    constexpr std::uint64_t kOctaves = 14, kTintOctaves = 4, kTintPattern = 100;
    float brightness = 0, tint = 0, amplitude = 0.36f;
    glm::vec2 at = place / size;
    float wavelength = size;
    for (std::uint64_t octave = 0; octave < kOctaves; ++octave) {
        if (!(std::abs(at.x) < 1e9f && std::abs(at.y) < 1e9f) || wavelength < finest)
            break; // beyond the lattice's exact integers, or finer than a pixel sees: an octave fades out before it is
                   // dropped
        const float fade = std::min(1.f, wavelength / finest - 1);
        brightness += fade * amplitude * lattice_noise(at, octave);
        if (octave < kTintOctaves)
            tint += fade * 0.3f * lattice_noise(at, octave + kTintPattern);
        amplitude *= 0.9f;
        // Each octave is turned, so that the lattices don't line up.
        at = 2.f * glm::vec2(0.8f * at.x - 0.6f * at.y, 0.6f * at.x + 0.8f * at.y) + 17.f;
        wavelength *= 0.5f;
    }
    // Two thirds of the range for brightness, one third for the tint.
    brightness = std::clamp(brightness, -1.f, 1.f) * 2 / 3;
    tint = std::clamp(tint, -1.f, 1.f) / 3;
    return 1.f + spread * (brightness + tint * glm::vec3(0.8f, -0.2f, 0.1f));
}

GroundLook::GroundLook(const ShadedScene& scene, const RayQueries& queries, const Environment& environment,
                       const Backdrop& backdrop, const Camera& camera, const PictureOptions& options) {
    const Bounds bounds = bounds_of(*scene.patches);
    if (scene.patches->ground) {
        plane_.emplace(scene.patches->ground->height_m, queries.ray_offset());
        albedo_ = scene.patches->ground->albedo;
    } else if (options.ground == PictureGround::automatic) {
        if (environment.has_lower_half && scene.patches->triangles.empty())
            return; // nothing that could cast a shadow
        plane_.emplace(scene.foot_height.value_or(bounds.low.y), queries.ray_offset());
        if (!environment.has_lower_half)
            albedo_ = glm::vec3(0.2f);
    } else {
        return;
    }
    const glm::vec3 half = 0.5f * (bounds.high - bounds.low);
    centre_ = {bounds.centre().x, bounds.centre().z};
    pixel_angle_ = 2 * std::tan(0.5f * camera.vertical_field_of_view) / float(options.height);
    scene_radius_ = std::max({half.x, half.y, half.z});
    haze_distance_ = 30 * std::max(2 * scene_radius_, 4 * std::abs(camera.position.y - plane_->height_m()));
    if (!(haze_distance_ > 0))
        haze_distance_ = 1;
    if (albedo_)
        measure_haze(backdrop);
}

float GroundLook::distance(const glm::vec3& origin, const glm::vec3& direction) const {
    return plane_ ? plane_->distance(origin, direction) : kInfinity;
}

float GroundLook::distance_to_surfaces(float ground_distance, const glm::vec3& direction) const {
    return plane_ ? plane_->distance_to_surfaces(ground_distance, direction) : kInfinity;
}

glm::vec3 GroundLook::albedo(const glm::vec3& point, const glm::vec3& direction, float distance) const {
    // The variation shrinks to nothing as the albedo nears 1, where it could only lose energy.
    const float spread = 0.4f * std::clamp(1 - std::max({albedo_->r, albedo_->g, albedo_->b}), 0.f, 1.f);
    // A pixel's footprint is longer along the view than across: the mean of both.
    const float footprint = 1.3f * pixel_angle_ * distance / std::sqrt(std::max(-direction.y, 1e-3f));
    return *albedo_ *
           ground_variation(glm::vec2(point.x, point.z) - centre_, 0.5f * haze_distance_ / 30, footprint, spread);
}

float GroundLook::clear(float distance) const {
    return std::exp(-distance / haze_distance_);
}

float GroundLook::away(const glm::vec3& point) const {
    return glm::length(glm::vec2(point.x, point.z) - centre_) / std::max(scene_radius_, 1e-30f);
}

/// Air mixes the light of a wide part of the horizon: the mean over azimuth, weighted by the squared cosine of how far
/// it lies to the side. (One direction's alone would draw every tree and house of the horizon down into the ground.)
void GroundLook::measure_haze(const Backdrop& backdrop) {
    constexpr int kAzimuths = 128;
    const auto turn = [](int i) { return 2 * kPi * float(i) / kAzimuths; };
    std::vector<glm::vec3> horizon;
    for (int i = 0; i < kAzimuths; ++i)
        horizon.push_back(backdrop.remainder(glm::normalize(glm::vec3(std::cos(turn(i)), 0.01f, std::sin(turn(i))))));
    haze_.assign(kAzimuths, glm::vec3(0.f));
    for (int i = 0; i < kAzimuths; ++i) {
        float weights = 0;
        for (int k = -kAzimuths / 4; k <= kAzimuths / 4; ++k) {
            const float weight = std::cos(turn(k)) * std::cos(turn(k));
            haze_[std::size_t(i)] += weight * horizon[std::size_t((i + k + kAzimuths) % kAzimuths)];
            weights += weight;
        }
        haze_[std::size_t(i)] /= weights;
    }
}

glm::vec3 GroundLook::haze(const glm::vec3& direction) const {
    const float count = float(haze_.size());
    const float place = (std::atan2(direction.z, direction.x) / (2 * kPi) + 1) * count, floor = std::floor(place);
    const auto at = [&](float i) { return haze_[std::size_t(i) % haze_.size()]; };
    return glm::mix(at(floor), at(floor + 1), place - floor);
}

} // namespace kokage
