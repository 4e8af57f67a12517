#include "reflection/light_map_gloss.h"
#include "common/directions/spherical_harmonics.h"
#include "common/services/error.h"
#include "reflection/glossy_light.h"
#include "reflection/light_map_readers.h"
#include "reflection/view_frustum.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace kokage {
namespace {

constexpr int kMostBands = 10;
constexpr std::size_t kMostCount = sh_count(kMostBands);
constexpr int kLobeSteps = 128;
constexpr float kLeastOfBand = 0.002f; ///< of a lobe's first: wide lobes leave little of fine bands

/// In eight sums, which a compiler may keep in one register.
float dot(const float* a, const float* b, std::size_t count) {
    std::array<float, 8> sums{};
    std::size_t j = 0;
    for (; j + 8 <= count; j += 8)
        for (std::size_t k = 0; k < 8; ++k)
            sums[k] += a[j + k] * b[j + k];
    float rest = 0;
    for (; j < count; ++j)
        rest += a[j] * b[j];
    for (const float sum : sums)
        rest += sum;
    return rest;
}

void check(const LightMapsOfPatches& maps, std::size_t patches) {
    const auto fail = [](const std::string& what) { throw InputError("picture: the scene's light maps " + what); };
    if (maps.shares.size() != patches * maps.per_patch)
        fail("have " + std::to_string(maps.shares.size()) + " shares where " +
             std::to_string(patches * maps.per_patch) + " are needed");
    for (const LightMap& map : maps.maps)
        if (map.bands < 1 || map.bands > kMostBands || map.bands != maps.maps.front().bands ||
            map.coefficients.size() != sh_count(map.bands))
            fail("must all have the same number of bands, 1 to " + std::to_string(kMostBands));
    for (const LightMapShare& share : maps.shares)
        if (share.map >= maps.maps.size())
            fail("are " + std::to_string(maps.maps.size()) + ", and a patch reads number " + std::to_string(share.map));
}

bool reads(std::span<const LightMapShare> shares) {
    return std::any_of(shares.begin(), shares.end(), [](const LightMapShare& share) { return share.share > 0; });
}

} // namespace

float least_map_roughness(const Environment& environment) {
    constexpr float kStep = 0.01f;
    for (float roughness = kLeastMapRoughness; roughness <= 1; roughness += kStep)
        if (std::none_of(environment.distant_lights.begin(), environment.distant_lights.end(),
                         [&](const DistantLight& light) { return is_wide_for(light, roughness); }))
            return roughness;
    return 2;
}

std::vector<std::uint8_t> light_map_readers(const ShadedScene& scene, const Environment& environment,
                                            const Camera& camera, const PictureOptions& options) {
    const PatchScene& patches = *scene.patches;
    std::vector<std::uint8_t> readers(patches.patches.size(), 0);
    if (!options.pixel_shadows || options.samples >= kTooManySamplesForMaps)
        return readers;
    const float least = least_map_roughness(environment);
    std::vector<std::uint8_t> reading;
    for (const SurfaceLook& look : scene.looks)
        reading.push_back(look.smooth_normals && !look.gloss.is_matt() && roughness_bounds(look.gloss).most >= least);
    const ViewFrustum view(camera_frame(camera, options.width, options.height));
    for (std::size_t t = 0; t < scene.triangle_look.size(); ++t) {
        if (!reading[scene.triangle_look[t]] || readers[patches.triangle_patch[t]])
            continue;
        const glm::uvec3 corners = patches.triangles[t];
        const glm::vec3 a = patches.positions[corners.x];
        const float radius =
            std::max(glm::distance(a, patches.positions[corners.y]), glm::distance(a, patches.positions[corners.z]));
        if (view.may_see(a, radius + scene.looks[scene.triangle_look[t]].relief.depth_m))
            readers[patches.triangle_patch[t]] = 1;
    }
    return readers;
}

LightMapGloss::LightMapGloss(const ShadedScene& scene, const Environment& environment, const SurfaceShading& surfaces)
    : scene_(scene), surfaces_(surfaces) {
    if (scene.light_maps.empty())
        return;
    check(scene.light_maps, scene.patches->patches.size());
    least_roughness_ = least_map_roughness(environment);
    count_ = scene.light_maps.maps.front().coefficients.size();
    number_slots();
    mix_at_corners();
    fill_lobes();
}

std::size_t LightMapGloss::bytes() const {
    return slot_.size() * sizeof(std::uint32_t) + values_.size() * sizeof(float) + factors_.size() * sizeof(glm::vec3);
}

double LightMapGloss::most_bytes(double places, double slots, int bands) {
    const double area = sizeof(float); // while maps are mixed
    return places * double(sizeof(std::uint32_t)) +
           slots * (3 * double(sh_count(bands) * sizeof(float)) + double(sizeof(glm::vec3)) + area);
}

template <typename Visit>
void LightMapGloss::for_each_triangle_that_reads(Visit&& visit) const {
    const PatchScene& patches = *scene_.patches;
    for (std::size_t p = 0; p < patches.patches.size(); ++p) {
        if (!reads(scene_.light_maps.of(p)))
            continue;
        const Patch& patch = patches.patches[p];
        for (std::uint32_t t = patch.first_triangle; t < patch.first_triangle + patch.triangle_count; ++t) {
            SurfacePoint at;
            at.triangle = t;
            at.patch = std::uint32_t(p);
            at.smooth = scene_.looks[scene_.triangle_look[t]].smooth_normals;
            if (at.smooth)
                visit(at, surfaces_.places(at).places);
        }
    }
}

/// Counts them before any is made: an array that grows takes thrice its size.
void LightMapGloss::number_slots() {
    slot_.assign(surfaces_.light_count() / 2, 0);
    std::uint32_t count = 0;
    for_each_triangle_that_reads([&](const SurfacePoint&, const std::array<std::uint32_t, 3>& places) {
        for (const std::uint32_t place : places)
            if (slot_[place] == 0)
                slot_[place] = ++count;
    });
    values_.assign(count * 3 * count_, 0.f);
    factors_.assign(count, glm::vec3(1.f));
}

void LightMapGloss::mix_at_corners() {
    const PatchScene& patches = *scene_.patches;
    std::vector<float> areas(factors_.size(), 0.f), mix(3 * count_);
    std::uint32_t mixed_patch = ~0u;
    for_each_triangle_that_reads([&](const SurfacePoint& at, const std::array<std::uint32_t, 3>& places) {
        if (at.patch != mixed_patch) {
            mixed_patch = at.patch;
            std::fill(mix.begin(), mix.end(), 0.f);
            for (const LightMapShare& share : scene_.light_maps.of(at.patch))
                for (std::size_t j = 0; j < count_; ++j)
                    for (std::size_t c = 0; c < 3; ++c)
                        mix[c * count_ + j] += share.share * scene_.light_maps.maps[share.map].coefficients[j][c];
        }
        const glm::uvec3 triangle = patches.triangles[at.triangle];
        const glm::vec3 a = patches.positions[triangle.x];
        const float area = std::max(
            glm::length(glm::cross(patches.positions[triangle.y] - a, patches.positions[triangle.z] - a)), 1e-20f);
        for (const std::uint32_t place : places) {
            const std::size_t slot = slot_[place] - 1;
            areas[slot] += area;
            float* values = values_.data() + slot * mix.size();
            for (std::size_t j = 0; j < mix.size(); ++j)
                values[j] += area * mix[j];
        }
    });
    for (std::size_t k = 0; k < areas.size(); ++k)
        for (std::size_t j = 0; j < mix.size(); ++j)
            values_[k * mix.size() + j] /= areas[k];
}

void LightMapGloss::fill_lobes() {
    const int bands = scene_.light_maps.maps.front().bands;
    for (int step = 0; step <= kLobeSteps; ++step)
        for (const double k : lobe_coefficients({LobeKind::ggx, std::max(step, 1) / double(kLobeSteps)}, bands))
            lobes_.push_back(float(k));
}

void LightMapGloss::fall_off(float roughness, std::span<float> of_bands) const {
    const float at = std::clamp(roughness, 0.f, 1.f) * kLobeSteps;
    const std::size_t step = std::min(std::size_t(at), std::size_t(kLobeSteps - 1));
    const float* row = lobes_.data() + step * of_bands.size();
    for (std::size_t l = 0; l < of_bands.size(); ++l)
        of_bands[l] = row[l] + (at - float(step)) * (row[l + of_bands.size()] - row[l]);
}

bool LightMapGloss::lights(const SurfacePoint& at) const {
    if (empty() || !at.smooth || !at.front || at.roughness < least_roughness_)
        return false;
    for (const std::uint32_t place : surfaces_.places(at).places)
        if (slot_[place] == 0)
            return false;
    return true;
}

glm::vec3 LightMapGloss::radiance(const SurfacePoint& at, const glm::vec3& mirrored) const {
    const LightPlaces from = surfaces_.places(at);
    const HorizonLookup lobe = horizon_.lookup(at.normal, mirrored, double(at.roughness));
    int bands = scene_.light_maps.maps.front().bands;
    std::array<float, kMostBands> of_bands;
    fall_off(lobe.parameter, {of_bands.data(), std::size_t(bands)});
    while (bands > 1 && std::abs(of_bands[std::size_t(bands - 1)]) < kLeastOfBand * of_bands[0])
        --bands;
    const std::size_t count = sh_count(bands);
    std::array<float, kMostCount> harmonics;
    evaluate_sh(bands, lobe.directions[0], {harmonics.data(), count});
    for (int l = 0; l < bands; ++l)
        for (std::size_t j = sh_index(l, -l); j <= sh_index(l, l); ++j)
            harmonics[j] *= of_bands[std::size_t(l)];
    glm::vec3 sum(0.f), factor(0.f);
    for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t slot = slot_[from.places[k]] - 1;
        const float weight = from.weights[glm::length_t(k)];
        factor += weight * factors_[slot];
        for (std::size_t c = 0; c < 3; ++c)
            sum[glm::length_t(c)] += weight * dot(harmonics.data(), values_.data() + (3 * slot + c) * count_, count);
    }
    return lobe.share * factor * glm::max(sum, glm::vec3(0.f));
}

} // namespace kokage
