#pragma once
// Reading light-environment maps at a leaf by [F]'s rule (eqs 2-4).
#include "foliage/captured_maps.h"

#include <span>

namespace kokage {

/// The direction in which a point reads a map [F section 3]. d is the unit vector from the point to the map.
///   outside its sphere: d (eq 2), the light that reaches the map along that line, from beyond it;
///   inside:            -d (eq 3, read as the antipodal direction), the light that comes from the point's own side.
/// On the sphere counts as inside. At the map's own position there is no direction: 0.
glm::vec3 reading_direction(const LightMapPlace& place, const glm::vec3& point);

/// The value of one map in a direction; for direction 0 its mean over all directions.
glm::vec3 read_map(const MapCoefficients& coefficients, std::size_t map, const glm::vec3& direction);

/// S = (1/N) sum of L_i over all N maps (eq 4), for every point. Maps of up to 40 bands. The obvious twin of
/// mean_of_maps is mean_of_maps_at, one point at a time.
std::vector<glm::vec3> mean_of_maps(std::span<const LightMapPlace> places, const MapCoefficients& coefficients,
                                    std::span<const glm::vec3> points);
glm::vec3 mean_of_maps_at(std::span<const LightMapPlace> places, const MapCoefficients& coefficients,
                          const glm::vec3& point);

} // namespace kokage
