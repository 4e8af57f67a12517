#pragma once
// Which share of every light is seen from a list of points. Kept between solves: only lights that moved are traced
// again.
#include "common/environment/environment.h"
#include "foliage/light_map_capture.h"

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace kokage {

class LightVisibility {
  public:
    /// `queries` must outlive it. A distant light is sampled `samples` times from each point.
    LightVisibility(const RayQueries& queries, std::vector<CapturePoint> points, int samples, std::uint64_t seed);

    /// Share in [0,1] of the light that each point sees; valid until the next forget_unused().
    const std::vector<float>& of(const DistantLight& light, Progress& progress);
    const std::vector<float>& of(const PointLight& light, Progress& progress);
    /// Drops what no call has asked for since the last forget_unused().
    void forget_unused();

    std::uint64_t rays_traced() const { return rays_; }
    std::size_t bytes() const;

  private:
    struct Entry {
        std::vector<float> visible;
        bool used = true;
    };
    Entry* find(std::uint64_t key);

    const RayQueries& queries_;
    std::vector<CapturePoint> points_;
    int samples_;
    std::uint64_t seed_;
    std::unordered_map<std::uint64_t, Entry> entries_;
    std::uint64_t rays_ = 0;
};

/// Irradiance of a point light on a surface that faces it; finite even at the light itself (distances below `least_m`
/// count as that).
glm::vec3 facing_irradiance(const PointLight& light, const glm::vec3& point, float least_m);

/// Keys of lights' places and shapes, not of their colours (a region's spread of light over its texels is part of its
/// shape).
std::uint64_t shape_key(const DistantLight& light);
std::uint64_t shape_key(const PointLight& light);

} // namespace kokage
