#pragma once
// One scattering: the radiance of all sides -> what the lines carry -> irradiance -> radiance. The inner loop of
// everything that bounces.
#include "foliage/bundles/bundle_tracing.h"

#include <span>

namespace kokage::bundles {

/// RGB and a pad, so that a side is one aligned vector.
struct alignas(16) Rgb {
    float r = 0, g = 0, b = 0, pad = 0;
    glm::vec3 vec() const { return {r, g, b}; }
    static Rgb from(const glm::vec3& v) { return {v.x, v.y, v.z, 0}; }
};

inline constexpr std::size_t kSweepBlock = Links::kBlock / 2; ///< patches that are done together

/// What one link of a side brings it, per side: pi (1 - open) / links, where open is the share of the side's
/// cosine-weighted hemisphere that links don't fill.
std::vector<float> link_weights(const Links& links, std::span<const float> open);

/// How two radiances differ, all sides together.
struct RadianceChange {
    double largest = 0, largest_radiance = 0;
    glm::dvec3 total{0.0}, total_radiance{0.0};
};

/// The last sweeps, newest first: the radiance that each read and what it made of it. Per side; empty = none.
struct SweepHistory {
    std::span<const Rgb> read[2], made[2];
};

/// Inner products, per channel, of a sweep's residual f0 = made - read with the changes of residuals d1 = f0 - f1 and
/// d2 = f1 - f2 since the sweeps of a history.
struct HistoryProducts {
    glm::dvec3 d1_d1{0.0}, d1_d2{0.0}, d2_d2{0.0}, d1_f0{0.0}, d2_f0{0.0};
};

/// One scattering of `radiance` along the links, added to what sides emit (light from outside, scattered once; empty =
/// none). All arrays are per side. Returns how the result differs from `radiance`. With a history of at least one
/// sweep, `products` receives its inner products (of large trees, those of a quarter of the sides).
RadianceChange scatter(const PatchScene& scene, const Links& links, const std::vector<Optics>& optics,
                       std::span<const float> weights, std::span<const Rgb> radiance, std::span<const Rgb> emitted,
                       std::span<Rgb> scattered, const SweepHistory* history = nullptr,
                       HistoryProducts* products = nullptr);

/// Irradiance from outside, scattered once.
void scatter_outside(const PatchScene& scene, const std::vector<Optics>& optics, std::span<const Rgb> irradiance,
                     std::span<Rgb> radiance);

/// What one half of the directions knows of light from outside; per side.
struct HalfLight {
    std::span<const Rgb> irradiance; ///< empty = none
    std::span<const float> open;
};
/// Two scatterings of `radiance`, each with the neighbours of one half of the directions and with its own light from
/// outside (a half without neighbours makes do with both). Written are half the difference of the radiances and the
/// mean irradiance. Only every `stride`-th block of kSweepBlock patches is done; the others are left as they are.
void scatter_halves(const PatchScene& scene, const Links& links, const std::vector<Optics>& optics,
                    std::span<const Rgb> radiance, const HalfLight (&halves)[2], std::span<Rgb> half_difference,
                    std::span<Rgb> mean_irradiance, std::size_t stride = 1);

} // namespace kokage::bundles
