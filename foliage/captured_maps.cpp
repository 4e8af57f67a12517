#include "foliage/captured_maps.h"
#include "common/directions/spherical_harmonics.h"
#include "common/environment/light_harmonics.h"
#include "common/services/parallel.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kokage {

void MapCoefficients::scale_bands(std::span<const double> factors) {
    for (std::size_t map = 0; map < maps_; ++map)
        for (int c = 0; c < 3; ++c)
            for (int l = 0; l < bands_; ++l)
                for (int m = -l; m <= l; ++m)
                    channel(map, c)[sh_index(l, m)] *= float(factors[std::size_t(l)]);
}

CapturedMaps::CapturedMaps(const RayQueries& queries, const GroundCells& ground, std::vector<LightMapPlace> places,
                           int bands, int least_directions, Progress& progress)
    : places_(std::move(places)), bands_(bands), directions_(make_capture_directions(bands, least_directions)) {
    const std::size_t count = sh_count(bands);
    weighted_harmonics_.resize(directions_.size() * count);
    std::vector<double> harmonics(count);
    for (std::size_t k = 0; k < directions_.size(); ++k) {
        evaluate_sh(bands, glm::dvec3(directions_.directions[k]), harmonics);
        for (std::size_t j = 0; j < count; ++j)
            weighted_harmonics_[k * count + j] = float(harmonics[j] * directions_.solid_angles[k]);
    }
    capture_ = capture(queries, ground, points(), directions_.directions, progress);
}

std::vector<CapturePoint> CapturedMaps::points() const {
    std::vector<CapturePoint> result;
    for (const LightMapPlace& place : places_)
        result.push_back({place.position, place.clearance_m});
    return result;
}

namespace {

/// coefficients += radiance of each direction x its weighted harmonics. `radiance(k)` is asked once per direction.
/// Runs of directions are summed in float and the runs in double, so that a constant is kept to 1e-6.
template <class Radiance>
void add_map(std::size_t map, std::size_t directions, const std::vector<float>& weighted_harmonics,
             const Radiance& radiance, MapCoefficients& coefficients) {
    constexpr std::size_t kRun = 32;
    const std::size_t count = coefficients.count();
    std::vector<float> run(3 * count);
    std::vector<double> total(3 * count, 0.0);
    float *red = run.data(), *green = red + count, *blue = green + count;
    for (std::size_t first = 0; first < directions; first += kRun) {
        std::fill(run.begin(), run.end(), 0.f);
        for (std::size_t k = first; k < std::min(first + kRun, directions); ++k) {
            const glm::vec3 value = radiance(k);
            if (value == glm::vec3(0.f))
                continue;
            const float* harmonics = weighted_harmonics.data() + k * count;
            for (std::size_t j = 0; j < count; ++j) {
                red[j] += value.r * harmonics[j];
                green[j] += value.g * harmonics[j];
                blue[j] += value.b * harmonics[j];
            }
        }
        for (std::size_t j = 0; j < total.size(); ++j)
            total[j] += double(run[j]);
    }
    float* sums = coefficients.channel(map, 0); // red, green and blue follow each other
    for (std::size_t j = 0; j < total.size(); ++j)
        sums[j] += float(total[j]);
}

} // namespace

void CapturedMaps::add_sky(std::span<const glm::vec3> sky, MapCoefficients& coefficients) const {
    parallel_blocks(places_.size(), 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t map = begin; map < end; ++map) {
            const auto seen = capture_.seen_from(map);
            add_map(
                map, directions_.size(), weighted_harmonics_,
                [&](std::size_t k) { return seen[k] == kSeesSky ? sky[k] : glm::vec3(0.f); }, coefficients);
        }
    });
}

void CapturedMaps::add_surfaces(const SideRadiance& tree, std::span<const glm::vec3> ground,
                                MapCoefficients& coefficients) const {
    parallel_blocks(places_.size(), 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t map = begin; map < end; ++map) {
            const auto seen = capture_.seen_from(map);
            add_map(
                map, directions_.size(), weighted_harmonics_,
                [&](std::size_t k) { return seen_radiance(seen[k], tree, ground); }, coefficients);
        }
    });
}

void CapturedMaps::add_lights(const Environment& environment, LightVisibility& visibility, float least_m,
                              MapCoefficients& coefficients, Progress& progress) const {
    for (const DistantLight& light : environment.distant_lights) {
        const std::vector<float>& visible = visibility.of(light, progress);
        const std::vector<glm::vec3> projected = project_light(light, bands_);
        for (std::size_t map = 0; map < places_.size(); ++map)
            for (std::size_t j = 0; j < projected.size(); ++j)
                coefficients.add(map, j, visible[map] * projected[j]);
    }
    std::vector<double> harmonics(sh_count(bands_));
    for (const PointLight& light : environment.point_lights) {
        const std::vector<float>& visible = visibility.of(light, progress);
        for (std::size_t map = 0; map < places_.size(); ++map) {
            const glm::dvec3 to = glm::dvec3(light.position) - glm::dvec3(places_[map].position);
            const double distance = glm::length(to);
            const glm::vec3 irradiance = visible[map] * facing_irradiance(light, places_[map].position, least_m);
            if (distance > 0)
                evaluate_sh(bands_, to / distance, harmonics);
            else { // a light at the map itself comes from everywhere alike
                std::fill(harmonics.begin(), harmonics.end(), 0.0);
                harmonics[0] = 0.5 / std::sqrt(kPiDouble);
            }
            for (std::size_t j = 0; j < harmonics.size(); ++j)
                coefficients.add(map, j, irradiance * float(harmonics[j]));
        }
    }
}

std::vector<LightMap> CapturedMaps::export_maps(const MapCoefficients& coefficients) const {
    std::vector<LightMap> maps(places_.size());
    for (std::size_t i = 0; i < maps.size(); ++i) {
        maps[i].position = places_[i].position;
        maps[i].radius_m = places_[i].radius_m;
        maps[i].generation = places_[i].generation;
        maps[i].bands = bands_;
        for (std::size_t j = 0; j < coefficients.count(); ++j)
            maps[i].coefficients.push_back(coefficients.at(i, j));
    }
    return maps;
}

std::size_t CapturedMaps::bytes() const {
    return capture_.seen.size() * (sizeof(std::uint32_t) + sizeof(float)) + weighted_harmonics_.size() * sizeof(float);
}

} // namespace kokage
