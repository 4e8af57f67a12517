#include "foliage/map_reading.h"
#include "common/directions/spherical_harmonics.h"
#include "common/services/parallel.h"

#include <algorithm>
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

namespace {

/// Harmonics by recurrence with everything that depends on l and m alone made beforehand:
///     Y_l,m = N_lm(z) Re (x+iy)^m,  Y_l,-m = N_lm(z) Im (x+iy)^m  (legendre.h),
///     N_mm = start_m,  N_lm = rise_lm (z N_{l-1,m} - fall_lm N_{l-2,m}).
struct Recurrence {
    std::vector<float> start, rise, fall; ///< rise and fall: m (m = 0 ... ) by l, bands x bands

    explicit Recurrence(int bands) : start(std::size_t(bands)), rise(sh_count(bands), 0.f), fall(sh_count(bands), 0.f) {
        double factor = 0.5 / std::sqrt(kPiDouble);
        for (int m = 0; m < bands; ++m) {
            if (m > 0)
                factor *= std::sqrt((2 * m + 1.0) / (2 * m)) * (m == 1 ? std::sqrt(2.0) : 1.0);
            start[std::size_t(m)] = float(factor);
            for (int l = m + 1; l < bands; ++l) {
                const double l2 = double(l) * l, m2 = double(m) * m, below = (l - 1.0) * (l - 1.0);
                rise[std::size_t(m * bands + l)] = float(std::sqrt((4 * l2 - 1) / (l2 - m2)));
                fall[std::size_t(m * bands + l)] = float(std::sqrt(std::max(0.0, (below - m2) / (4 * below - 1))));
            }
        }
    }
};

/// Points that are read side by side; compilers turn the loops over them into vector code.
constexpr std::size_t kLanes = 16;
struct Lanes {
    alignas(64) float v[kLanes];
    float& operator[](std::size_t i) { return v[i]; }
    float operator[](std::size_t i) const { return v[i]; }
};

/// sums += one map, read in the direction (x, y, z) of every lane.
void add_readings(const Recurrence& recurrence, const MapCoefficients& coefficients, std::size_t map, const Lanes& x,
                  const Lanes& y, const Lanes& z, Lanes (&sums)[3]) {
    const int bands = coefficients.bands();
    Lanes cosine, sine, n, before; // of m times the azimuth, times sin^m of the polar angle; N_lm and N_{l-1,m}
    for (std::size_t i = 0; i < kLanes; ++i) {
        cosine[i] = 1;
        sine[i] = 0;
    }
    for (int m = 0; m < bands; ++m) {
        if (m > 0)
            for (std::size_t i = 0; i < kLanes; ++i) {
                const float c = cosine[i] * x[i] - sine[i] * y[i];
                sine[i] = cosine[i] * y[i] + sine[i] * x[i];
                cosine[i] = c;
            }
        for (std::size_t i = 0; i < kLanes; ++i) {
            n[i] = recurrence.start[std::size_t(m)];
            before[i] = 0;
        }
        for (int l = m; l < bands; ++l) {
            if (l > m) {
                const float rise = recurrence.rise[std::size_t(m * bands + l)],
                            fall = recurrence.fall[std::size_t(m * bands + l)];
                for (std::size_t i = 0; i < kLanes; ++i) {
                    const float next = rise * (z[i] * n[i] - fall * before[i]);
                    before[i] = n[i];
                    n[i] = next;
                }
            }
            for (int c = 0; c < 3; ++c) {
                const float* channel = coefficients.channel(map, c);
                const float even = channel[sh_index(l, m)], odd = m > 0 ? channel[sh_index(l, -m)] : 0.f;
                Lanes& sum = sums[c];
                for (std::size_t i = 0; i < kLanes; ++i)
                    sum[i] += n[i] * (even * cosine[i] + odd * sine[i]);
            }
        }
    }
}

/// Up to kLanes points. A point at a map's own place has no direction: it takes the map's mean.
void mean_of_block(const Recurrence& recurrence, std::span<const LightMapPlace> places,
                   const MapCoefficients& coefficients, std::span<const glm::vec3> points, std::span<glm::vec3> means) {
    Lanes x{}, y{}, z{}, total[3] = {};
    for (std::size_t map = 0; map < places.size(); ++map) {
        Lanes sums[3] = {};
        for (std::size_t i = 0; i < points.size(); ++i) {
            const glm::vec3 direction = reading_direction(places[map], points[i]);
            x[i] = direction.x;
            y[i] = direction.y;
            z[i] = direction.z;
        }
        add_readings(recurrence, coefficients, map, x, y, z, sums);
        const glm::vec3 mean = coefficients.at(map, 0) * kMeanOfY00;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const bool nowhere = x[i] == 0 && y[i] == 0 && z[i] == 0;
            for (std::size_t c = 0; c < 3; ++c)
                total[c][i] += nowhere ? mean[c] : sums[c][i];
        }
    }
    for (std::size_t i = 0; i < points.size(); ++i)
        means[i] = glm::vec3(total[0][i], total[1][i], total[2][i]) / float(places.size());
}

} // namespace

std::vector<glm::vec3> mean_of_maps(std::span<const LightMapPlace> places, const MapCoefficients& coefficients,
                                    std::span<const glm::vec3> points) {
    std::vector<glm::vec3> means(points.size(), glm::vec3(0.f));
    if (places.empty())
        return means;
    const Recurrence recurrence(coefficients.bands());
    parallel_blocks(points.size(), 16 * kLanes, [&](std::size_t begin, std::size_t end) {
        for (std::size_t first = begin; first < end; first += kLanes) {
            const std::size_t count = std::min(kLanes, end - first);
            mean_of_block(recurrence, places, coefficients, points.subspan(first, count),
                          std::span(means).subspan(first, count));
        }
    });
    return means;
}

} // namespace kokage
