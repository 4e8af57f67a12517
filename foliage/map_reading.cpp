#include "foliage/map_reading.h"
#include "common/directions/spherical_harmonics.h"
#include "common/services/parallel.h"

#include <cmath>

namespace kokage {

glm::vec3 reading_direction(const LightMapPlace& place, const glm::vec3& point) {
    const glm::vec3 to_map = place.position - point;
    const float distance = glm::length(to_map);
    if (!(distance > 0))
        return glm::vec3(0.f);
    const glm::vec3 d = to_map / distance;
    return distance > place.radius_m ? d : -d;
}

namespace {

constexpr float kMeanOfY00 = 0.28209479177387814f; // 1/sqrt(4 pi): the mean of a map is its constant term's value

glm::vec3 read(const MapCoefficients& coefficients, std::size_t map, const glm::vec3& direction,
               std::vector<float>& harmonics) {
    if (direction == glm::vec3(0.f))
        return coefficients.at(map, 0) * kMeanOfY00;
    evaluate_sh(coefficients.bands(), direction, harmonics);
    const float* red = coefficients.channel(map, 0);
    const float* green = coefficients.channel(map, 1);
    const float* blue = coefficients.channel(map, 2);
    glm::vec3 sum{0.f};
    for (std::size_t j = 0; j < coefficients.count(); ++j)
        sum += harmonics[j] * glm::vec3(red[j], green[j], blue[j]);
    return sum;
}

glm::vec3 mean_at(std::span<const LightMapPlace> places, const MapCoefficients& coefficients, const glm::vec3& point,
                  std::vector<float>& harmonics) {
    glm::vec3 sum{0.f};
    for (std::size_t map = 0; map < places.size(); ++map)
        sum += read(coefficients, map, reading_direction(places[map], point), harmonics);
    return places.empty() ? glm::vec3(0.f) : sum / float(places.size());
}

} // namespace

glm::vec3 read_map(const MapCoefficients& coefficients, std::size_t map, const glm::vec3& direction) {
    std::vector<float> harmonics(coefficients.count());
    return read(coefficients, map, direction, harmonics);
}

glm::vec3 mean_of_maps_at(std::span<const LightMapPlace> places, const MapCoefficients& coefficients,
                          const glm::vec3& point) {
    std::vector<float> harmonics(coefficients.count());
    return mean_at(places, coefficients, point, harmonics);
}

std::vector<glm::vec3> mean_of_maps(std::span<const LightMapPlace> places, const MapCoefficients& coefficients,
                                    std::span<const glm::vec3> points) {
    std::vector<glm::vec3> means(points.size());
    parallel_blocks(points.size(), 256, [&](std::size_t begin, std::size_t end) {
        std::vector<float> harmonics(coefficients.count());
        for (std::size_t i = begin; i < end; ++i)
            means[i] = mean_at(places, coefficients, points[i], harmonics);
    });
    return means;
}

} // namespace kokage
