#include "foliage/bundles/line_directions.h"

#include "common/environment/lat_long.h"
#include "common/services/random.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

namespace kokage::bundles {
namespace {

/// A uniformly random rotation (Shoemake 1992, Uniform Random Rotations).
glm::mat3 random_rotation(Random& random) {
    const float u0 = random.uniform(), u1 = 2 * kPi * random.uniform(), u2 = 2 * kPi * random.uniform();
    const float a = std::sqrt(1 - u0), b = std::sqrt(u0);
    return glm::mat3_cast(glm::quat(b * std::cos(u2), a * std::sin(u1), a * std::cos(u1), b * std::sin(u2)));
}

/// Every second point of a Fibonacci hemisphere of `count` points, from `first` on, turned by a rotation.
void add_half(int count, int first, const glm::mat3& rotation, std::vector<glm::vec3>& directions) {
    const double golden = kPiDouble * (3 - std::sqrt(5.0));
    for (int i = first; i < count; i += 2) {
        const double z = (i + 0.5) / count, r = std::sqrt(1 - z * z), azimuth = golden * i;
        glm::vec3 d = rotation * glm::vec3(r * std::cos(azimuth), r * std::sin(azimuth), z);
        if (d.y > 0)
            d = -d;
        directions.push_back(glm::normalize(d));
    }
}

/// Pixels of a lat-long image gathered into at most 128 x 64 cells: irradiance-weighted means with their solid angles.
struct Cell {
    glm::vec3 direction;
    glm::dvec3 flux;
    double solid_angle;
};

std::vector<Cell> coarse_cells(const Image& image) {
    const int width = std::min(image.width, 128), height = std::min(image.height, 64);
    std::vector<Cell> cells(std::size_t(width) * height, {glm::vec3(0.f), glm::dvec3(0.0), 0.0});
    for (int y = 0; y < image.height; ++y) {
        const double solid_angle = pixel_solid_angle(y, image.width, image.height);
        const int row = int(std::int64_t(y) * height / image.height);
        for (int x = 0; x < image.width; ++x) {
            Cell& cell = cells[std::size_t(row) * width + std::size_t(std::int64_t(x) * width / image.width)];
            const float* pixel = image.at(x, y);
            cell.flux += solid_angle * glm::dvec3(pixel[0], pixel[1], pixel[2]);
            cell.solid_angle += solid_angle;
        }
    }
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            cells[std::size_t(y) * width + x].direction =
                direction_from_lat_long({(x + 0.5f) / width, (y + 0.5f) / height});
    return cells;
}

/// Scales the radiance of ends [begin, end) so that its mean is that of the light that went to them, which is
/// flux[2 i + below] of a solid angle.
void keep_mean(std::size_t begin, std::size_t end, std::size_t below, const std::vector<glm::dvec3>& flux,
               const std::vector<double>& solid_angle, std::vector<glm::vec3>& radiance) {
    glm::dvec3 light(0.0), drawn(0.0);
    double all = 0;
    for (std::size_t i = begin; i < end; ++i) {
        light += flux[2 * i + below];
        all += solid_angle[2 * i + below];
        drawn += glm::dvec3(radiance[i]) / double(end - begin);
    }
    for (glm::length_t c = 0; c < 3; ++c)
        if (all > 0 && drawn[c] > 0)
            for (std::size_t i = begin; i < end; ++i)
                radiance[i][c] *= float(light[c] / all / drawn[c]);
}

} // namespace

LineDirections make_line_directions(int count, std::uint64_t seed) {
    LineDirections lines;
    lines.half = std::uint32_t(std::max(1, (count + 1) / 2));
    Random random(seed, 0x6c696e65);
    const glm::mat3 rotation = random_rotation(random);
    for (int h = 0; h < 2; ++h)
        add_half(2 * int(lines.half), h, rotation, lines.directions);
    return lines;
}

EndRadiance end_radiance(const Image& remainder, const LineDirections& lines) {
    const std::size_t count = lines.directions.size();
    EndRadiance radiance{std::vector<glm::vec3>(count, glm::vec3(0.f)), std::vector<glm::vec3>(count, glm::vec3(0.f))};
    std::vector<glm::dvec3> flux(2 * count, glm::dvec3(0.0));
    std::vector<double> solid_angle(2 * count, 0.0);
    for (const Cell& cell : coarse_cells(remainder))
        for (std::size_t begin : {std::size_t(0), std::size_t(lines.half)}) {
            const std::size_t end = begin == 0 ? lines.half : count;
            // Near ends lie above the horizon, far ends below: light never changes sides.
            const bool below = cell.direction.y < 0;
            const glm::vec3 towards = below ? cell.direction : -cell.direction;
            float best = -2;
            std::size_t nearest = begin;
            for (std::size_t i = begin; i < end; ++i)
                if (const float cosine = glm::dot(lines.directions[i], towards); cosine > best) {
                    best = cosine;
                    nearest = i;
                }
            flux[2 * nearest + below] += cell.flux;
            solid_angle[2 * nearest + below] += cell.solid_angle;
        }
    // Every line stands for the same solid angle, but the cells that lie nearest to it don't: each half's mean is set
    // right, so that no light is won or lost.
    for (std::size_t i = 0; i < count; ++i) {
        auto mean = [&](std::size_t end, const glm::vec3& direction) {
            return solid_angle[end] > 0 ? glm::vec3(flux[end] / solid_angle[end])
                                        : lat_long_radiance(remainder, direction);
        };
        radiance.near_end[i] = mean(2 * i, -lines.directions[i]);
        radiance.far_end[i] = mean(2 * i + 1, lines.directions[i]);
    }
    for (std::size_t begin : {std::size_t(0), std::size_t(lines.half)}) {
        const std::size_t end = begin == 0 ? lines.half : count;
        keep_mean(begin, end, 0, flux, solid_angle, radiance.near_end);
        keep_mean(begin, end, 1, flux, solid_angle, radiance.far_end);
    }
    return radiance;
}

} // namespace kokage::bundles
